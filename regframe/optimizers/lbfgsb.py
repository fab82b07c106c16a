"""The quasi-Newton method L-BFGS-B, by scipy."""

import math
from collections.abc import Generator
from functools import partial
from typing import Self, final

import numpy as np
from pydantic import Field, model_validator

from regframe.errors import NoOverlapError
from regframe.optimizers.base import Normals, Optimizer, Problem, Step
from regframe.optimizers.handover import Cost, Report, turns
from regframe.types import Params

_ENDLESS = 2**31 - 1  # the engine's budget ends the search, not scipy's
_NO_LOWER_PLACE = 2  # scipy's status, which it calls abnormal


@final
class Lbfgsb(Optimizer):
    """Walk downhill by the slope and the curvature that past slopes reveal, within bounds.

    R. Byrd, P. Lu, J. Nocedal and C. Zhu, "A limited memory algorithm for bound constrained optimization",
    SIAM J. Scientific Computing 16(5), 1995, as `scipy.optimize` has it. `itk::LBFGSBOptimizerv4` uses an
    older version of the same program: both end at the same optimum on different paths. Scales other than
    `shift` are ignored, as ITK ignores them. It wants a slope that fits the value: use `gradient = "exact"`.

    scipy calls back where an engine wants a generator, so it runs on a thread of its own, in turns with the
    engine's: each iteration is handed over as it happens, and the engine may stop at any of them. A level's
    `iterations` counts scipy's iterations; ITK's observers are told of evaluations, of which an
    iteration takes one or a few. A probe where nothing overlaps counts as worse than all before, so that
    the search comes back.
    """

    gradient_tolerance: float = Field(
        1e-5,
        ge=0,
        allow_inf_nan=False,
        description="Stop once the slope's largest component, as far as bounds leave it, is below this.",
    )
    convergence_factor: float = Field(
        1e7,
        ge=0,
        allow_inf_nan=False,
        description=(
            "Stop once an iteration lowers the value by less than this multiple of the machine precision: "
            "1e12 is coarse, 1e7 moderate, 10 as exact as can be."
        ),
    )
    corrections: int = Field(5, ge=1, description="Number of past steps that the curvature is learnt from.")
    line_iterations: int = Field(20, ge=1, description="Most evaluations of a line search.")
    lower: float | None = Field(
        None,
        allow_inf_nan=False,
        description=(
            "Lowest coordinate of every parameter: pixels (or mm) of motion from the level's start, unless "
            "the stage has own scales; then the parameter itself. None is no bound."
        ),
    )
    upper: float | None = Field(
        None, allow_inf_nan=False, description="Highest coordinate of all parameters."
    )

    @model_validator(mode="after")
    def _bounds_fit(self) -> Self:
        if self.lower is not None and self.upper is not None and not self.lower < self.upper:
            message = f"`lower` must be below `upper` ({self.upper:g}): exchange them, or leave one out"
            raise ValueError(message)
        return self

    def steps(self, problem: Problem, start: Params, rng: Normals) -> Generator[Step, None, str]:
        """Yield scipy's position and value an iteration, and the length of its move."""
        here = np.array(start, dtype=np.float64)
        walk = turns(partial(self._minimize, here.copy()), _Cautious(problem))
        try:
            while True:
                try:
                    reached = next(walk)
                except StopIteration as end:
                    return str(end.value)
                moved, here = math.dist(reached.at, here), reached.at
                yield Step(here, reached.value, moved)
        finally:
            walk.close()

    def _minimize(self, start: Params, cost: Cost, report: Report) -> str:
        """The whole search; the reason why scipy ended it."""
        from scipy.optimize import Bounds, OptimizeResult, minimize

        def callback(intermediate_result: OptimizeResult) -> None:
            report(intermediate_result.x, float(intermediate_result.fun))

        bounds = Bounds(
            -np.inf if self.lower is None else self.lower, np.inf if self.upper is None else self.upper
        )
        options = {
            "maxcor": self.corrections,
            "ftol": self.convergence_factor * float(np.finfo(np.float64).eps),
            "gtol": self.gradient_tolerance,
            "maxls": self.line_iterations,
            "maxiter": _ENDLESS,
            "maxfun": _ENDLESS,
        }
        found = minimize(
            cost, start, method="L-BFGS-B", jac=True, bounds=bounds, callback=callback, options=options
        )
        if found.status == _NO_LOWER_PLACE:
            return "the line search finds no lower place: the slope does not fit the value here"
        return f"scipy's L-BFGS-B: {str(found.message).lower().strip(' :')}"


class _Cautious:
    """A problem whose places without overlap are a little worse than any place met."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.met: list[float] = []

    def __call__(self, at: Params) -> tuple[float, Params]:
        """Value and slope."""
        try:
            value, slope = self.problem.value_and_gradient(at)
        except NoOverlapError:
            if not self.met:
                raise
            # A finite value: scipy's line search interpolates, and cannot from an infinite one.
            worst = max(self.met)
            return worst + max(worst - min(self.met), abs(worst), 1e-3), np.zeros_like(at)
        self.met.append(value)
        return value, slope
