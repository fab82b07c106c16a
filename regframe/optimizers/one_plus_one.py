"""The (1+1) evolution strategy with a direction-learning matrix."""

import math
from collections.abc import Generator
from typing import Literal, final

import numpy as np
from pydantic import Field

from regframe.kernels.variates import Wallace
from regframe.optimizers.base import Normals, Optimizer, Problem, Step
from regframe.types import Matrix, Params, Values


@final
class OnePlusOne(Optimizer):
    """One parent, one child an iteration: the child is kept when it is better.

    M. Styner, C. Brechbuehler, G. Szekely and G. Gerig, "Parametric estimate of intensity inhomogeneities
    applied to MRI", IEEE Trans. Medical Imaging 19(3), 2000. Steps are normal deviates times a matrix that
    grows along the direction of a success and shrinks along that of a failure. With ITK's scales and
    `Wallace` variates it walks the path of `itk::OnePlusOneEvolutionaryOptimizerv4` bit for bit.

    Two departures from ITK: a child whose value is infinite or no number is refused and the run goes on,
    also where ITK's Mattes metric would abort it; and a success in the very iteration that stops is a step
    of its own, where ITK tells no observer.
    """

    radius: float = Field(
        1.5,
        gt=0,
        allow_inf_nan=False,
        description=(
            "Standard deviation of the first steps, along each coordinate: pixels (or mm) of motion, "
            "unless the stage has scales of its own. In four coordinates, 300 steps end about a third of it "
            "from the optimum: smaller is more exact, larger leaves poor optima more easily."
        ),
    )
    growth: float = Field(
        1.05,
        gt=1,
        allow_inf_nan=False,
        description="Factor on the search radius along the direction of a success.",
    )
    shrink: float | None = Field(
        None,
        gt=0,
        lt=1,
        description=(
            "Factor on the search radius along the direction of a failure; none means growth ** -0.25, "
            "which keeps the radius where one child in five succeeds."
        ),
    )
    epsilon: float = Field(
        1.5e-4,
        ge=0,
        allow_inf_nan=False,
        description=(
            "Stop once the Frobenius norm of the search matrix is this small; in pixels (or mm) of motion, "
            "like the radius."
        ),
    )
    variates: Literal["wallace", "numpy"] = Field(
        "wallace",
        description="Who draws the normal deviates: ITK's generator (Wallace, 1996), or numpy's default one.",
    )

    def normals(self, seed: int) -> Normals:
        """The generator that `variates` names, seeded."""
        return Wallace(seed) if self.variates == "wallace" else np.random.default_rng(seed)

    def steps(self, problem: Problem, start: Params, rng: Normals) -> Generator[Step, None, str]:
        """Yield the parent an iteration: its position, its value, and the search matrix's norm.

        Every iteration measures one child, and the start is measured before the first.
        """
        shrink = self.growth**-0.25 if self.shrink is None else self.shrink
        matrix: Matrix = np.diag(self.radius / problem.scales)
        parent = np.array(start, dtype=np.float64)
        best = _measure(problem, parent)
        while True:
            drawn = rng.standard_normal(len(parent))
            # cumsum adds from left to right, as ITK does; matmul and sum may not.
            move = np.cumsum(matrix * drawn, axis=1)[:, -1]
            child = parent + move
            value = _measure(problem, child)
            better = value < best
            if better:
                parent, best = child, value
            size = math.sqrt(_total(matrix * matrix))
            if size <= self.epsilon:
                if better:
                    yield Step(parent, best, size)
                return f"the search radius {size:.3g} has fallen to epsilon ({self.epsilon:g})"
            factor = self.growth if better else shrink
            scaled = (factor - 1.0) / _total(drawn * drawn) * move
            matrix = matrix + np.outer(scaled, drawn)
            yield Step(parent, best, size)


def _measure(problem: Problem, at: Params) -> float:
    """The problem's value at one position; infinite where it is no number."""
    value = float(problem.values(at[None])[0])
    return value if math.isfinite(value) else math.inf


def _total(terms: Values) -> float:
    """The sum, from left to right."""
    return float(np.cumsum(terms)[-1])
