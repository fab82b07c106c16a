"""The simplex of Nelder and Mead, within bounds and with steps that suit the number of parameters."""

import math
from collections.abc import Callable, Generator
from typing import NamedTuple, final

import numpy as np
from pydantic import Field

from regframe.optimizers.base import Normals, Optimizer, Problem, Step
from regframe.optimizers.descent import effective
from regframe.types import Params


class _Corner(NamedTuple):
    value: float
    at: Params


class _Steps(NamedTuple):
    """How far a simplex reflects, expands, contracts and shrinks."""

    expand: float
    contract: float
    shrink: float


Measure = Callable[[Params], _Corner]


@final
class NelderMead(Optimizer):
    """A simplex crawls downhill without slopes, and never leaves a box about the start.

    J. Nelder and R. Mead, "A simplex method for function minimization", The Computer Journal 7(4), 1965, in
    the variant of J. Lagarias and others, SIAM J. Optimization 9(1), 1998, with the steps of F. Gao and
    L. Han, Computational Optimization and Applications 51(1), 2012, which do not stall in many parameters:
    for 8 of them the simplex expands to 1.25 instead of 2 times a step. Corners beyond the box are put on its
    wall. A simplex that has become flat or small while the budget lasts is built anew about the best
    corner, half as large, up to `restarts` times.

    It differs from `amoeba`, which walks as ITK's does: that one has no bounds, the steps of 1965, and
    takes an expansion or contraction only if it beats the best corner, so that it shrinks, which costs an
    evaluation a parameter, where this one contracts.
    """

    size: float = Field(
        2.0,
        gt=0,
        allow_inf_nan=False,
        description=(
            "Length of the first simplex along each parameter: pixels (or mm) of motion, or with own scales "
            "the parameter's change times its scale."
        ),
    )
    bound: float | None = Field(
        None,
        gt=0,
        allow_inf_nan=False,
        description="How far each parameter may move from the level's start, in the unit of `size`.",
    )
    restarts: int = Field(1, ge=0, description="How often a simplex that has closed up is built anew.")
    size_tolerance: float = Field(
        1e-2,
        ge=0,
        allow_inf_nan=False,
        description="A simplex has closed up once its corners are this near to its best one, in that unit.",
    )
    value_tolerance: float = Field(
        1e-7,
        ge=0,
        allow_inf_nan=False,
        description="It must also differ in value by no more than this share of the best value.",
    )

    def steps(self, problem: Problem, start: Params, rng: Normals) -> Generator[Step, None, str]:
        """Yield the best corner a change of the simplex: its place, its value, the simplex's size."""
        scales = effective(problem.scales)
        origin = np.array(start, dtype=np.float64) * scales
        reach = math.inf if self.bound is None else self.bound

        def measured(at: Params) -> _Corner:
            inside = at if self.bound is None else np.clip(at, origin - reach, origin + reach)
            return _Corner(float(problem.values((inside / scales)[None])[0]), inside)

        best, length, how = measured(origin), self.size, _gao_han(len(origin))
        for _ in range(self.restarts + 1):
            corners = sorted([best, *map(measured, _around(best.at, length, origin, reach))], key=_value)
            while not self._closed(corners):
                corners = _changed(corners, measured, how)
                yield Step(corners[0].at / scales, corners[0].value, _size(corners))
            best, length = corners[0], length / 2
            yield Step(best.at / scales, best.value, _size(corners))
        return f"the simplex is smaller than size_tolerance ({self.size_tolerance:g}) and as alike in value"

    def _closed(self, corners: list[_Corner]) -> bool:
        spread = corners[-1].value - corners[0].value
        alike = spread <= self.value_tolerance * max(abs(corners[0].value), 1e-12)
        return _size(corners) <= self.size_tolerance and alike


def _gao_han(count: int) -> _Steps:
    """Steps by the number of parameters; those of 1965 for one or two."""
    most = max(count, 2)
    return _Steps(1 + 2 / most, 0.75 - 1 / (2 * most), 1 - 1 / most)


def _around(at: Params, length: float, origin: Params, reach: float) -> list[Params]:
    """The other corners of a first simplex, each stepping away from the nearer wall."""
    steps = np.where(at + length > origin + reach, -length, length)
    return list(at + np.diag(steps))


def _changed(corners: list[_Corner], measured: Measure, how: _Steps) -> list[_Corner]:
    """The simplex, from best to worst, after one reflection, expansion, contraction or shrinking."""
    best, second, worst = corners[0], corners[-2], corners[-1]
    centre = np.add.reduce([corner.at for corner in corners[:-1]]) / (len(corners) - 1)
    away = centre - worst.at
    reflected = measured(centre + away)
    if reflected.value < best.value:
        expanded = measured(centre + how.expand * away)
        chosen = expanded if expanded.value < reflected.value else reflected
    elif reflected.value < second.value:
        chosen = reflected
    else:
        outside = reflected.value < worst.value
        chosen = measured(centre + (how.contract if outside else -how.contract) * away)
        if not chosen.value < min(reflected.value, worst.value):
            shrunk = [measured(best.at + how.shrink * (corner.at - best.at)) for corner in corners[1:]]
            return sorted([best, *shrunk], key=_value)
    return sorted([*corners[:-1], chosen], key=_value)


def _size(corners: list[_Corner]) -> float:
    """The farthest that a corner is from the best one, along any axis."""
    return float(np.abs(np.array([corner.at for corner in corners[1:]]) - corners[0].at).max())


def _value(corner: _Corner) -> float:
    return corner.value
