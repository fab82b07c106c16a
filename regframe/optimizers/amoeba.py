"""The downhill simplex of Nelder and Mead."""

from collections.abc import Callable, Generator
from itertools import pairwise
from typing import NamedTuple, final

import numpy as np
from pydantic import Field

from regframe.optimizers.base import Normals, Optimizer, Problem, Step
from regframe.optimizers.descent import effective
from regframe.types import Params


class _Corner(NamedTuple):
    value: float
    at: Params


Measure = Callable[[Params], _Corner]


@final
class Amoeba(Optimizer):
    """A simplex of one corner more than there are parameters crawls downhill, without slopes.

    J. Nelder and R. Mead, "A simplex method for function minimization", The Computer Journal 7(4), 1965,
    in the variant of `itk::AmoebaOptimizerv4` (vnl_amoeba), whose corners it visits: an expansion and a
    contraction must beat the *best* corner.

    ITK limits the number of evaluations; here a level's `iterations` counts changes of the simplex, which
    cost 1 or 2 evaluations, or 2 and one a parameter where the simplex shrinks. ITK's restarts are left out.
    """

    simplex_delta: float = Field(
        2.0,
        gt=0,
        allow_inf_nan=False,
        description=(
            "Length of the first simplex along each parameter: pixels (or mm) of motion, or with own scales "
            "the parameter's change times its scale."
        ),
    )
    parameters_tolerance: float = Field(
        1e-3,
        ge=0,
        allow_inf_nan=False,
        description=(
            "Stop once the simplex is this small, in the unit of `simplex_delta`, and the values of its "
            "corners are as alike as `value_tolerance` says. ITK's default is 1e-8."
        ),
    )
    value_tolerance: float = Field(
        1e-4,
        ge=0,
        allow_inf_nan=False,
        description="Difference between the worst and the best corner's value at which to stop; see above.",
    )

    def steps(self, problem: Problem, start: Params, rng: Normals) -> Generator[Step, None, str]:
        """Yield the best corner a change of the simplex: its place, its value, the simplex's size."""
        scales = effective(problem.scales)

        def measured(at: Params) -> _Corner:
            return _Corner(float(problem.values((at / scales)[None])[0]), at)

        corners = [measured(at) for at in self._first(np.array(start, dtype=np.float64) * scales)]
        corners.sort(key=_value)
        while True:
            size, spread = _size(corners), corners[-1].value - corners[0].value
            if size < self.parameters_tolerance and spread < self.value_tolerance:
                return (
                    f"the simplex {size:.3g} is smaller than parameters_tolerance "
                    f"({self.parameters_tolerance:g}), and its values as alike as value_tolerance"
                )
            corners = _changed(corners, measured)
            yield Step(corners[0].at / scales, corners[0].value, _size(corners))

    def _first(self, at: Params) -> list[Params]:
        return [at, *(at + axis * self.simplex_delta for axis in np.eye(len(at)))]


def _changed(corners: list[_Corner], measured: Measure) -> list[_Corner]:
    """The simplex, from best to worst, after one reflection, expansion, contraction or shrinking."""
    best, worst = corners[0], corners[-1]
    # Added from left to right, as ITK does.
    centre = np.cumsum([corner.at for corner in corners[:-1]], axis=0)[-1] / (len(corners) - 1)
    reflected = measured(2.0 * centre - worst.at)
    if reflected.value < corners[-2].value:
        chosen = reflected
        if reflected.value < best.value:
            expanded = measured(2.0 * reflected.at - centre)
            chosen = expanded if expanded.value < best.value else reflected
    else:
        nearer = reflected if reflected.value < worst.value else worst
        chosen = measured(0.5 * centre + 0.5 * nearer.at)
        if not chosen.value < best.value:
            shrunk = [measured((corner.at + best.at) / 2.0) for corner in corners[1:]]
            return sorted([best, *shrunk], key=_value)
    return sorted([*corners[:-1], chosen], key=_value)


def _size(corners: list[_Corner]) -> float:
    """The largest step between neighbours in the sorted list, along any axis."""
    return max(float(np.abs(other.at - one.at).max()) for one, other in pairwise(corners))


def _value(corner: _Corner) -> float:
    return corner.value
