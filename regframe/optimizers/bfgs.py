"""The quasi-Newton method BFGS, for few parameters near an optimum."""

from collections.abc import Generator
from typing import final

import numpy as np
from pydantic import Field

from regframe.errors import NoOverlapError
from regframe.optimizers.base import Normals, Optimizer, Problem, Step
from regframe.types import Matrix, Params

SHRINK = (0.1, 0.5)
"""Bounds of the factor on a step that went too far."""
ENOUGH = 1e-4
"""Share of the fall that the slope promises with which a step is content (Armijo's condition)."""


@final
class Bfgs(Optimizer):
    """Walk downhill by the slope and the curvature that past slopes reveal, in few evaluations.

    Nocedal and Wright, "Numerical Optimization", 2nd edition, 2006, algorithm 6.1, with backtracking in
    place of a line search for curvature: an update is left out where the curvature is not positive. The
    first step has a given length, and none is longer than another: in pixels (or mm) of motion, unless the
    stage has own scales. For a handful of parameters; `lbfgsb` is for thousands. It wants a slope that fits
    the value: use `gradient = "exact"`.
    """

    first_step: float = Field(0.5, gt=0, description="Length of the first step.")
    longest_step: float = Field(4.0, gt=0, description="No step is longer.")
    tolerance: float = Field(0.01, ge=0, description="Stop after a step that is shorter.")
    backtracks: int = Field(6, ge=1, le=60, description="Most times that a step is shortened.")

    def steps(self, problem: Problem, start: Params, rng: Normals) -> Generator[Step, None, str]:
        """Yield the position, its value, and the length of the step to it."""
        here = np.array(start, np.float64)
        value, slope = problem.value_and_gradient(here)
        inverse: Matrix | None = None
        while True:
            if not slope.any():
                return "the slope is 0"
            move = self._direction(inverse, slope)
            reached = self._backtrack(problem, here, (value, slope), move)
            if reached is None and inverse is not None:
                # The curvature may be that of a place far behind: once more along the slope alone.
                inverse, move = None, self._direction(None, slope)
                reached = self._backtrack(problem, here, (value, slope), move)
            if reached is None:
                return "no lower place along the slope"
            there, value, steeper = reached
            made = there - here
            inverse = _updated(inverse, made, steeper - slope)
            here, slope, length = there, steeper, float(np.linalg.norm(made))
            yield Step(here, value, length)
            if length < self.tolerance:
                return f"a step shorter than {self.tolerance:g}"

    def _direction(self, inverse: Matrix | None, slope: Params) -> Params:
        if inverse is None:
            return -slope * (self.first_step / float(np.linalg.norm(slope)))
        move = -(inverse @ slope)
        return move * min(1.0, self.longest_step / max(float(np.linalg.norm(move)), 1e-300))

    def _backtrack(
        self, problem: Problem, here: Params, met: tuple[float, Params], move: Params
    ) -> tuple[Params, float, Params] | None:
        """Position, value and slope after as much of a move as goes downhill; None if nothing does."""
        value, slope = met
        for _ in range(self.backtracks):
            falls = float(slope @ move)
            there = problem.advance(here, move)
            try:
                reached, steeper = problem.value_and_gradient(there)
            except NoOverlapError:
                move = move * SHRINK[1]
                continue
            if reached <= value + ENOUGH * falls:
                return there, reached, steeper
            # The lowest point of the parabola through both values and the slope.
            factor = -falls / max(2.0 * (reached - value - falls), 1e-300)
            move = move * min(max(factor, SHRINK[0]), SHRINK[1])
        return None


def _updated(inverse: Matrix | None, made: Params, change: Params) -> Matrix | None:
    """The inverse curvature after a step and the change of slope that it made."""
    along = float(made @ change)
    if along <= 1e-12 * float(np.linalg.norm(made) * np.linalg.norm(change)):
        return inverse
    one = np.eye(len(made))
    if inverse is None:
        inverse = one * (along / float(change @ change))
    left = one - np.outer(made, change) / along
    return np.asarray(left @ inverse @ left.T + np.outer(made, made) / along)
