"""Every position of a regular lattice about the start."""

import math
from collections.abc import Generator, Iterator
from itertools import product
from typing import Annotated, ClassVar, Literal, final

import numpy as np
from pydantic import Field

from regframe.errors import PresetError
from regframe.optimizers.base import Normals, Optimizer, Problem, Step
from regframe.types import Params


@final
class Exhaustive(Optimizer):
    """Measure every position of a lattice about the start, and take the lowest.

    `itk::ExhaustiveOptimizerv4`, whose positions it visits in ITK's order, the first parameter fastest.
    Good for finding a start among many valleys, for plots of a metric, and as a proof that there is no
    better place nearby; the number of positions grows with the power of the parameters' number.

    There is one step a position, so `iterations` of a level must reach the lattice's size, which is the
    product of 2 n + 1 over all parameters; a smaller one cuts the scan. Scales *multiply* the step length,
    as in ITK.
    """

    scans: ClassVar[bool] = True

    number_of_steps: tuple[Annotated[int, Field(ge=0)], ...] = Field(
        (2,),
        min_length=1,
        description=(
            "Positions on each side of the start, one number a parameter, in the transform's order; a single "
            "number stands for all parameters, 0 leaves a parameter as it is."
        ),
    )
    step_length: float = Field(
        1.0,
        gt=0,
        allow_inf_nan=False,
        description="Distance of neighbours: pixels (or mm) of motion, unless the stage has own scales.",
    )
    tell: Literal["best", "each"] = Field(
        "best",
        description=(
            "What each step reports: the best position so far; or the one just measured and its value, as "
            "ITK's events do, and after the last one the best, which needs one iteration more."
        ),
    )

    def steps(self, problem: Problem, start: Params, rng: Normals) -> Generator[Step, None, str]:
        """Yield a step a position: what `tell` says, and the position's distance from the start."""
        begin = np.array(start, dtype=np.float64)
        counts = self._counts(len(begin))
        best, lowest = begin, _measure(problem, begin)
        for at in self._lattice(counts, problem.scales, begin):
            value = _measure(problem, at)
            if value < lowest:
                best, lowest = at, value
            shown = (best, lowest) if self.tell == "best" else (at, value)
            yield Step(*shown, math.dist(at, begin))
        if self.tell == "each":
            yield Step(best, lowest, math.dist(best, begin))
        return f"all {math.prod(2 * n + 1 for n in counts)} positions are measured"

    def _counts(self, parameters: int) -> tuple[int, ...]:
        if len(self.number_of_steps) == 1:
            return self.number_of_steps * parameters
        if len(self.number_of_steps) != parameters:
            message = (
                f"stages: optimizer: `number_of_steps` has {len(self.number_of_steps)} numbers and the "
                f"transform {parameters} parameters. Give one number a parameter, or one for all."
            )
            raise PresetError(message)
        return self.number_of_steps

    def _lattice(self, counts: tuple[int, ...], scales: Params, begin: Params) -> Iterator[Params]:
        for reversed_ in product(*(range(-n, n + 1) for n in reversed(counts))):
            offset = np.array(reversed_[::-1], dtype=np.float64)
            yield offset * self.step_length * scales + begin


def _measure(problem: Problem, at: Params) -> float:
    return float(problem.values(at[None])[0])
