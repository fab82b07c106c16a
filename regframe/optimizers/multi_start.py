"""Another optimizer, begun from several places."""

import math
from collections.abc import Generator
from typing import Annotated, final

import numpy as np
from pydantic import Field

from regframe.catalog import OPTIMIZERS
from regframe.errors import NoOverlapError
from regframe.optimizers.base import Normals, Optimizer, Problem, Step
from regframe.optimizers.descent import effective
from regframe.optimizers.nelder_mead import NelderMead
from regframe.types import Params

_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37)


@final
class MultiStart(Optimizer):
    """Run another optimizer from the start and from places around it, and keep the best.

    The places are points of Halton's sequence (J. Halton, Numerische Mathematik 2, 1960) in a box about the
    start: they fill it evenly and are the same in every run. All are measured; the lowest `walks` of
    them, the start always among these, are walked from, each for at most `patience` steps. It helps where the
    metric has several valleys about a rough start; `start = "search"` looks much farther. With more than
    twelve parameters the further ones keep their value.
    """

    optimizer: Annotated[Optimizer, OPTIMIZERS] = Field(
        default_factory=NelderMead, description="Who walks from each place."
    )
    starts: int = Field(16, ge=1, description="Places that are measured, beside the start.")
    walks: int = Field(3, ge=1, description="Places that are walked from, the start among them.")
    radius: float = Field(
        8.0,
        gt=0,
        allow_inf_nan=False,
        description=(
            "Half the width of the box: pixels (or mm) of motion, or with own scales the parameter's change "
            "times its scale."
        ),
    )
    patience: int = Field(
        200, ge=1, description="Most steps of a walk; `iterations` of a level counts those of all walks."
    )

    def steps(self, problem: Problem, start: Params, rng: Normals) -> Generator[Step, None, str]:
        """Yield the best position of all walks so far, and the length of the present walk's step."""
        origin = np.array(start, dtype=np.float64)
        best = Step(origin, float(problem.values(origin[None])[0]), 0.0)
        places = self._places(problem, origin)
        for place in places:
            walk = self.optimizer.steps(problem, place.copy(), rng)
            for _ in range(self.patience):
                try:
                    step = next(walk)
                except (StopIteration, NoOverlapError):
                    break
                best = step if step.value < best.value else best
                yield Step(best.params, best.value, step.size)
            walk.close()
        return f"all {len(places)} places are walked from; the best one has the value {best.value:.6g}"

    def _places(self, problem: Problem, origin: Params) -> list[Params]:
        """Where to walk from: the start, then the lowest of the others, the lowest first."""
        offsets = (2 * _halton(self.starts, len(origin)) - 1) * self.radius / effective(problem.scales)
        others = origin + offsets
        values = problem.values(others)
        order = np.argsort(values, kind="stable")
        near = [others[i] for i in order if math.isfinite(values[i])]
        return [origin, *near[: self.walks - 1]]


def _halton(count: int, dim: int) -> "np.ndarray[tuple[int, int], np.dtype[np.float64]]":
    """The first points of Halton's sequence in the unit box, (count, dim); 0.5 beyond the twelfth axis."""
    points = np.full((count, dim), 0.5)
    for axis, base in enumerate(_PRIMES[:dim]):
        for row in range(count):
            number, share, total = row + 1, 1.0, 0.0
            while number:
                number, digit = divmod(number, base)
                share /= base
                total += digit * share
            points[row, axis] = total
    return points
