"""Powell's direction sets: one line after the other, without slopes."""

import math
from collections.abc import Generator
from typing import Literal, NamedTuple, final

import numpy as np
from pydantic import Field

from regframe.optimizers.base import Normals, Optimizer, Problem, Step
from regframe.optimizers.brent import lowest
from regframe.optimizers.descent import effective
from regframe.types import Matrix, Params


@final
class Powell(Optimizer):
    """Search along one line a parameter, and replace the best line by the whole round's move.

    M. Powell, "An efficient method for finding the minimum of a function of several variables without
    calculating derivatives", The Computer Journal 7(2), 1964, with the line search of R. Brent,
    "Algorithms for Minimization without Derivatives", 1973; `itk::PowellOptimizerv4`, whose path it walks
    bit for bit.

    ITK that is told N iterations makes N + 1 rounds; here a level's `iterations` counts the rounds, each of
    about 14 evaluations a parameter. ITK that is ended by its limit leaves the transform at the last
    place probed, which can be far off; `keep` says which position is reported here. A round that moves and
    then stops is a step of its own, where ITK tells no observer.
    """

    step_length: float = Field(
        1.0,
        gt=0,
        allow_inf_nan=False,
        description="First step along each line: pixels (or mm) of motion, unless the stage has own scales.",
    )
    step_tolerance: float = Field(
        1e-3,
        gt=0,
        allow_inf_nan=False,
        description=(
            "Precision of each line search, in the unit of `step_length` and relative to the distance gone. "
            "ITK's default is 1e-6."
        ),
    )
    value_tolerance: float = Field(
        1e-6,
        ge=0,
        allow_inf_nan=False,
        description="Stop once a round changes the value by no more than this share of it.",
    )
    line_iterations: int = Field(
        100, ge=1, description="Most evaluations of a line search, after those that find its bracket."
    )
    keep: Literal["best", "last"] = Field(
        "best",
        description=(
            "Which position to report: the best one; or the last one probed, as ITK does, which may be an "
            "extrapolation beyond it."
        ),
    )

    def steps(self, problem: Problem, start: Params, rng: Normals) -> Generator[Step, None, str]:
        """Yield a step a round: the position that `keep` names, the best value, the round's whole move."""
        scales = effective(problem.scales)
        origin = np.array(start, dtype=np.float64)
        here = _Here(origin, _measure(problem, origin))
        lines, told = np.eye(len(origin)), origin
        while True:
            began = here
            here, best, drop = self._round(problem, here, lines / scales[:, None])
            moved = math.dist(here.at, began.at)
            if 2.0 * abs(began.value - here.value) <= self.value_tolerance * (
                abs(began.value) + abs(here.value)
            ):
                if not np.array_equal(told, here.at):
                    yield Step(here.at, here.value, moved)
                return f"a round changes the value by less than value_tolerance ({self.value_tolerance:g})"
            travel = (here.at - origin) * scales
            probe = 2.0 * here.at - origin
            origin = here.at
            reached = _measure(problem, probe)
            if reached < began.value and _worth(began.value, here.value, reached, drop):
                here, far = self._search(problem, here, travel / scales, 1.0)
                lines[:, best] = far * travel
                probe = here.at
            told = here.at if self.keep == "best" else probe
            yield Step(told, here.value, moved)

    def _round(self, problem: Problem, here: "_Here", lines: Matrix) -> tuple["_Here", int, float]:
        """One search along every line: where it ends, the line of the largest change, and that change."""
        best, drop = 0, 0.0
        for i in range(len(here.at)):
            before = here.value
            here, _ = self._search(problem, here, lines[:, i], self.step_length)
            if abs(before - here.value) > drop:
                best, drop = i, abs(before - here.value)
        return here, best, drop

    def _search(self, problem: Problem, here: "_Here", line: Params, step: float) -> tuple["_Here", float]:
        """Where the search along a line ends, and how far along the line that is."""

        def height(far: float) -> float:
            return _measure(problem, here.at + far * line)

        found = lowest(height, here.value, step, self.step_tolerance, self.line_iterations)
        return _Here(here.at + found.at * line, found.height), found.at


class _Here(NamedTuple):
    at: Params
    value: float


def _measure(problem: Problem, at: Params) -> float:
    return float(problem.values(at[None])[0])


def _worth(began: float, ended: float, reached: float, drop: float) -> bool:
    """Powell's test of whether the round's whole move is a better line than the best one."""
    bend = 2.0 * (began - 2.0 * ended + reached) * (began - ended - drop) ** 2
    return bend - drop * (began - reached) ** 2 < 0.0
