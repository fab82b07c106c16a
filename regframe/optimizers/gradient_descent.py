"""Gradient descent with a fixed or an estimated learning rate."""

from collections.abc import Generator
from typing import ClassVar, Literal, final

import numpy as np
from pydantic import Field

from regframe.optimizers.base import Normals, Optimizer, Problem, Step
from regframe.optimizers.convergence import Window
from regframe.optimizers.descent import (
    ConvergenceMinimum,
    ConvergenceWindow,
    Keep,
    LearningRate,
    MaximumStep,
    factors,
    learning_rate,
    length,
)
from regframe.types import Params


@final
class GradientDescent(Optimizer):
    """Walk downhill by steps as long as the slope is steep, until the value no longer falls.

    A. Cauchy, "Methode generale pour la resolution des systemes d'equations simultanees", Comptes rendus
    25, 1847; `itk::GradientDescentOptimizerv4`, whose path it walks. The learning rate is not corrected on
    the way: too large a one throws the images apart, so it is better estimated.

    Two departures from ITK: `keep` says which position is reported, where ITK returns the last; and the
    learning rate is estimated wherever that is asked for, where ITK does so only beside estimated scales.
    """

    weighs: ClassVar[bool] = True

    learning_rate: LearningRate = 1.0
    estimate_learning_rate: Literal["never", "once", "each-iteration"] = Field(
        "once",
        description=(
            "When to choose the learning rate, so that the step moves the grid by `maximum_step`: never, at "
            "the first iteration of each level, or each time, which makes all steps equally long."
        ),
    )
    maximum_step: MaximumStep = 1.0
    convergence_minimum: ConvergenceMinimum = 1e-6
    convergence_window: ConvergenceWindow = 10
    keep: Keep = "best"

    def steps(self, problem: Problem, start: Params, rng: Normals) -> Generator[Step, None, str]:
        """Yield a step an iteration.

        With `keep` "best": the best position measured so far and the value there. With "last": the
        position after the move and the value before it, as ITK's events tell. `Step.size` is the length
        of the move.
        """
        by = factors(problem)
        here = np.array(start, dtype=np.float64)
        value, uphill = problem.value_and_gradient(here)
        best, lowest = here, value
        window, rate = Window(self.convergence_window), self.learning_rate
        estimate = self.estimate_learning_rate != "never"
        while True:
            fall = window.push(value)
            if fall <= self.convergence_minimum:
                return (
                    f"the value's fall {fall:.3g} has come down to convergence_minimum "
                    f"({self.convergence_minimum:g})"
                )
            slope = -uphill * by
            if not np.isfinite(slope).all():
                return "the slope is not a finite number"
            if estimate:
                rate = learning_rate(problem, here, slope, self.maximum_step, otherwise=1.0)
                estimate = self.estimate_learning_rate == "each-iteration"
            move = slope * rate
            here = problem.advance(here, move)
            if self.keep == "last":
                # Measured only when the next step is asked for: ITK's last position never is.
                yield Step(here, value, length(move))
            value, uphill = problem.value_and_gradient(here)
            if self.keep == "best":
                if value < lowest or not np.isfinite(lowest):
                    best, lowest = here, value
                yield Step(best, lowest, length(move))
