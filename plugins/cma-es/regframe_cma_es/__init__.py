"""The evolution strategy with covariance matrix adaptation, an optimizer."""

from collections.abc import Generator
from typing import final

import numpy as np
from cmaes import CMA
from numpy.typing import NDArray
from pydantic import Field

from regframe import Optimizer, Problem, Step
from regframe.optimizers.base import Normals

Floats = NDArray[np.float64]
WORST = 1e300  # stands for "nothing overlaps": ranks alone count, but the package subtracts values


@final
class CmaEs(Optimizer):
    """A cloud of positions learns from its better half where to go and how to stretch, without slopes.

    N. Hansen and A. Ostermeier, "Completely derandomized self-adaptation in evolution strategies",
    Evolutionary Computation 9(2), 2001, as the package cmaes has it: M. Nomura and M. Shibata, "cmaes: a
    simple yet practical Python library for CMA-ES", 2024. One iteration is one generation. It wants two
    parameters or more.
    """

    sigma: float = Field(
        2.0, gt=0, allow_inf_nan=False, description="First spread of the cloud, pixels (or mm) of motion."
    )
    reach: float | None = Field(
        None,
        gt=0,
        allow_inf_nan=False,
        description="Bound on every coordinate, pixels (or mm) of motion from the start; none is no bound.",
    )
    population: int | None = Field(
        None, ge=4, le=10_000, description="Positions a generation; none is 4 + 3 ln(number of parameters)."
    )
    epsilon: float = Field(
        0.01,
        ge=0,
        allow_inf_nan=False,
        description="Stop once a generation spreads no wider than this, pixels (or mm) of motion.",
    )

    def steps(self, problem: Problem, start: Floats, rng: Normals) -> Generator[Step, None, str]:
        """Yield the best position met a generation, its value, and how wide the generation spread."""
        best, lowest = start.copy(), float(problem.values(start[None])[0])
        cloud = self._cloud(problem, start, rng)
        while not cloud.should_stop():
            batch = np.array([cloud.ask() for _ in range(cloud.population_size)])
            values = np.nan_to_num(problem.values(batch), nan=WORST, posinf=WORST)
            first = int(values.argmin())
            if values[first] < lowest:
                best, lowest = batch[first], float(values[first])
            cloud.tell(list(zip(batch, values.tolist(), strict=True)))
            size = float((batch * problem.scales).std(axis=0).max())
            yield Step(best.copy(), lowest, size)
            if size <= self.epsilon:
                return f"the spread {size:.3g} has fallen to epsilon ({self.epsilon:g})"
        return "the cloud can adapt no further: its values are all the same, or it is too flat"

    def _cloud(self, problem: Problem, start: Floats, rng: Normals) -> CMA:
        # The package draws from a generator of its own; its seed is the bits of a deviate of ours.
        seed = int(rng.standard_normal(1).view(np.uint64)[0] % 2**32)
        unit = 1.0 / problem.scales
        bounds = None if self.reach is None else start[:, None] + np.outer(unit, [-self.reach, self.reach])
        return CMA(
            mean=start.copy(),
            sigma=self.sigma,
            bounds=bounds,
            seed=seed,
            population_size=self.population,
            cov=np.diag(unit**2),
        )
