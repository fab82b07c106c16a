"""Descent whose every step is as long as a search along its direction says."""

import math
from abc import abstractmethod
from collections.abc import Callable, Generator
from typing import ClassVar, Literal, final

import numpy as np
from pydantic import Field

from regframe.optimizers.base import Normals, Optimizer, Problem, Step
from regframe.optimizers.convergence import Window
from regframe.optimizers.descent import (
    ConvergenceMinimum,
    ConvergenceWindow,
    LearningRate,
    MaximumStep,
    factors,
    learning_rate,
    length,
)
from regframe.types import Params

# ITK's golden ratio has seven digits.
_SECTION = 2.0 - 1.618034

Direction = Callable[[Params], Params]
Bracket = tuple[float, float, float]


class LineSearchDescent(Optimizer):
    """A descent that searches its learning rate anew by golden section at each iteration."""

    weighs: ClassVar[bool] = True

    learning_rate: LearningRate = 1.0
    estimate_learning_rate: Literal["never", "once"] = Field(
        "once",
        description=(
            "Whether the first search of each level begins with a learning rate that moves the grid by "
            "`maximum_step`, or with `learning_rate`; later ones begin with the last rate found."
        ),
    )
    maximum_step: MaximumStep = 1.0
    convergence_minimum: ConvergenceMinimum = 1e-6
    convergence_window: ConvergenceWindow = 10
    lower_limit: float = Field(
        0.0, ge=0, lt=1, description="Shortest step of a search, as a multiple of the learning rate."
    )
    upper_limit: float = Field(
        5.0,
        gt=1,
        allow_inf_nan=False,
        description="Longest step of a search, as a multiple of the learning rate.",
    )
    line_tolerance: float = Field(
        0.01,
        gt=0,
        allow_inf_nan=False,
        description="A search ends once its bracket is this narrow, relative to the step.",
    )
    line_iterations: int = Field(20, ge=1, description="Most rounds of a search, about one evaluation each.")
    keep: Literal["best", "itk"] = Field(
        "best",
        description=(
            "Which position to report: the best one an iteration reached, at the price of one more "
            "evaluation a level; or ITK's, reached from the best one without being measured itself."
        ),
    )

    @abstractmethod
    def direction(self) -> Direction:
        """A new function from downhill slope to direction of search, one a level; it may remember."""

    @final
    def steps(self, problem: Problem, start: Params, rng: Normals) -> Generator[Step, None, str]:
        """Yield an iteration's best position and value so far, and the length of its move."""
        by, turn = factors(problem), self.direction()
        here = np.array(start, dtype=np.float64)
        value, uphill = problem.value_and_gradient(here)
        best, lowest = here, value if self.keep == "best" else math.inf
        window, rate = Window(self.convergence_window), self.learning_rate
        estimate = self.estimate_learning_rate == "once"
        while True:
            fall = window.push(value)
            if fall <= self.convergence_minimum:
                return (
                    f"the value's fall {fall:.3g} has come down to convergence_minimum "
                    f"({self.convergence_minimum:g})"
                )
            heading = turn(-uphill * by)
            if not np.isfinite(heading).all():
                return "the slope is not a finite number"
            if estimate:
                rate = learning_rate(problem, here, heading, self.maximum_step, otherwise=1.0)
                estimate = False
            rate = self._search(problem, here, heading, rate)
            move = heading * rate
            here = problem.advance(here, move)
            if self.keep == "itk":
                if value < lowest:
                    best, lowest = here, value
                yield Step(best, lowest, length(move))
            value, uphill = problem.value_and_gradient(here)
            if self.keep == "best":
                if value < lowest:
                    best, lowest = here, value
                yield Step(best, lowest, length(move))

    def _search(self, problem: Problem, here: Params, heading: Params, rate: float) -> float:
        """The rate whose step ends lowest."""

        def height(factor: float) -> float:
            return float(problem.values(problem.advance(here, heading * factor)[None])[0])

        bracket = (rate * self.lower_limit, rate, rate * self.upper_limit)
        return golden(height, bracket, self.line_tolerance, self.line_iterations)


def golden(height: Callable[[float], float], bracket: Bracket, tolerance: float, rounds: int) -> float:
    """Where along a line it is lowest, by golden section as ITK does it.

    Parameters
    ----------
    height : callable
        Infinite where nothing overlaps: the search then turns to the nearer side.
    bracket : tuple of float
        Lower end, middle, upper end.
    tolerance : float
        Width of the bracket, relative to the place, at which to stop.
    rounds : int
        Round after which to stop.

    Examples
    --------
    >>> round(golden(lambda x: (x - 1.3) ** 2, (0.0, 1.0, 5.0), 1e-3, 50), 2)
    1.3
    """
    a, b, c = bracket
    middle: float | None = None
    for _ in range(rounds + 1):
        right = c - b > b - a
        x = b + _SECTION * (c - b) if right else b - _SECTION * (b - a)
        if abs(c - a) < tolerance * (abs(b) + abs(x)):
            break
        met = height(x)
        if middle is None:
            middle = height(b)
        if met < middle:
            a, b, c = (b, x, c) if right else (a, x, b)
            middle = met
        elif right:
            c = x
        elif math.isinf(met):
            b, c, middle = x, b, met
        else:
            a = x
    return (a + c) / 2.0
