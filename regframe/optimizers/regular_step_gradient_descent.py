"""Gradient descent whose step has a set length, halved at each turn."""

import math
from collections.abc import Generator
from typing import ClassVar, Literal, Self, final

import numpy as np
from pydantic import Field, model_validator

from regframe.optimizers.base import Normals, Optimizer, Problem, Step
from regframe.optimizers.descent import Keep, MaximumStep, dot, factors, learning_rate, length
from regframe.types import Params


@final
class RegularStepGradientDescent(Optimizer):
    """Walk downhill by steps of a set length, shortened whenever the slope turns back.

    `itk::RegularStepGradientDescentOptimizerv4`, whose path it walks. ITK returns the last position,
    though a better one may have been met; `keep` says which is reported here. The slope's size sets only
    the direction and the stop, never the step's length.
    """

    weighs: ClassVar[bool] = True

    learning_rate: float = Field(
        1.0,
        gt=0,
        allow_inf_nan=False,
        description="Length of the first step: pixels (or mm) of motion, unless the stage has own scales.",
    )
    minimum_step: float = Field(
        1e-3,
        gt=0,
        allow_inf_nan=False,
        description="Stop once the step is shorter than this; in the unit of the learning rate.",
    )
    relaxation: float = Field(
        0.5,
        gt=0,
        lt=1,
        description="Factor on the step's length whenever the slope turns back.",
    )
    gradient_tolerance: float = Field(
        1e-4,
        ge=0,
        allow_inf_nan=False,
        description="Stop once the slope, in metric units per pixel (or mm) of motion, is below this.",
    )
    estimate_learning_rate: Literal["never", "once", "each-iteration"] = Field(
        "never",
        description=(
            "When to choose the learning rate anew, so that the step moves the grid by `maximum_step`; "
            "once means at the first iteration of each level."
        ),
    )
    maximum_step: MaximumStep = 1.0
    keep: Keep = "best"

    @model_validator(mode="after")
    def _steps_fit(self) -> Self:
        if self.estimate_learning_rate == "never" and self.minimum_step > self.learning_rate:
            message = (
                f"`minimum_step` must not exceed `learning_rate` ({self.learning_rate:g}), "
                "or no step is made: lower it"
            )
            raise ValueError(message)
        return self

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
        before = np.zeros_like(here)
        relaxation, rate = 1.0, self.learning_rate
        estimate = self.estimate_learning_rate != "never"
        while True:
            slope = -uphill * by
            steepness = length(slope)
            reason = self._too_flat(steepness)
            if reason:
                return reason
            if dot(slope, before * by) < 0.0:
                relaxation *= self.relaxation
            if relaxation * rate < self.minimum_step:
                return (
                    f"the step {relaxation * rate:.3g} has fallen below minimum_step ({self.minimum_step:g})"
                )
            if estimate:
                # For the slope brought to length one, so that its size does not matter.
                rate = learning_rate(problem, here, slope / steepness, self.maximum_step, otherwise=steepness)
                estimate = self.estimate_learning_rate == "each-iteration"
            before = slope * relaxation * rate
            here = problem.advance(here, before * (1.0 / steepness))
            if self.keep == "last":
                # Measured only when the next step is asked for: ITK's last position never is.
                yield Step(here, value, relaxation * rate)
            value, uphill = problem.value_and_gradient(here)
            if self.keep == "best":
                if value < lowest or not math.isfinite(lowest):
                    best, lowest = here, value
                yield Step(best, lowest, relaxation * rate)

    def _too_flat(self, steepness: float) -> str:
        """Why to stop for the slope's size, or an empty string."""
        if not math.isfinite(steepness):
            return "the slope is not a finite number"
        if steepness < self.gradient_tolerance or steepness == 0.0:
            return (
                f"the slope {steepness:.3g} has fallen below gradient_tolerance ({self.gradient_tolerance:g})"
            )
        return ""
