"""Twins of the optimizers that regframe ships, and what their stages are in ITK's terms."""

from typing import TYPE_CHECKING, Any

import numpy as np

from regframe.errors import NoTwin
from regframe.optimizers.amoeba import Amoeba
from regframe.optimizers.conjugate_gradient_line_search import ConjugateGradientLineSearch
from regframe.optimizers.exhaustive import Exhaustive
from regframe.optimizers.gradient_descent import GradientDescent
from regframe.optimizers.gradient_descent_line_search import GradientDescentLineSearch
from regframe.optimizers.lbfgsb import Lbfgsb
from regframe.optimizers.line_search import LineSearchDescent
from regframe.optimizers.one_plus_one import OnePlusOne
from regframe.optimizers.powell import Powell
from regframe.optimizers.regular_step_gradient_descent import RegularStepGradientDescent
from regframe.peer import twins
from regframe.peer.twins import Terms
from regframe.preset import Stage
from regframe.types import Mask, Params

if TYPE_CHECKING:
    from regframe.peer.twins import Method

LAST = 'SimpleITK returns the last position, so keep = "last"'
LISTED = 'scales = "shift" is told as a list, measured once at the start of the stage'
FAR = 1e30
"""The scale of a parameter that must not move: its steps are lost in rounding."""
SMALLEST, LARGEST = float(np.finfo(np.float64).tiny), float(np.finfo(np.float64).max)
"""What SimpleITK takes for "no bound"."""


@twins.optimizer.register(OnePlusOne)
def _(ours: OnePlusOne, method: "Method", iterations: int, seed: int) -> None:
    shrink = -1.0 if ours.shrink is None else ours.shrink
    method.SetOptimizerAsOnePlusOneEvolutionary(
        iterations, ours.epsilon, ours.radius, ours.growth, shrink, seed
    )


@twins.terms.register(OnePlusOne)
def _(ours: OnePlusOne, stage: Stage, unit: Params) -> Terms:
    notes = []
    if stage.scales == "shift":
        # ITK begins with diag(radius / scale), so the motion per parameter itself is the scale.
        stage = _changed(stage, scales=tuple(map(float, unit)))
        notes.append(
            f"{LISTED}; epsilon is then compared with a norm in parameters, not in pixels, so a run that "
            "epsilon ends may end elsewhere"
        )
    if ours.variates != "wallace":
        notes.append(f'the draws of variates = "{ours.variates}" have no counterpart; SimpleITK uses its own')
    return Terms(stage, tuple(notes), alike=ours.variates == "wallace", draws=True)


@twins.optimizer.register(RegularStepGradientDescent)
def _(ours: RegularStepGradientDescent, method: "Method", iterations: int, seed: int) -> None:
    method.SetOptimizerAsRegularStepGradientDescent(
        ours.learning_rate,
        ours.minimum_step,
        iterations,
        ours.relaxation,
        ours.gradient_tolerance,
        _estimate(ours.estimate_learning_rate, method),
        ours.maximum_step,
    )


@twins.terms.register(RegularStepGradientDescent)
def _(ours: RegularStepGradientDescent, stage: Stage, unit: Params) -> Terms:
    stage, notes = itk_slopes(stage)
    if stage.scales == "shift":
        ours = ours.model_copy(
            update={"estimate_learning_rate": "each-iteration", "maximum_step": ours.learning_rate}
        )
        stage = _changed(stage, scales="physical-shift")
        notes += (
            'steps in pixels of motion are told as scales = "physical-shift" with a learning rate estimated '
            f"at each iteration for {ours.maximum_step:g} of motion",
        )
    if ours.keep == "best":
        ours = ours.model_copy(update={"keep": "last"})
        notes += (LAST,)
    return Terms(_changed(stage, optimizer=ours), notes)


@twins.optimizer.register(GradientDescent)
def _(ours: GradientDescent, method: "Method", iterations: int, seed: int) -> None:
    method.SetOptimizerAsGradientDescent(
        ours.learning_rate,
        iterations,
        ours.convergence_minimum,
        ours.convergence_window,
        _estimate(ours.estimate_learning_rate, method),
        ours.maximum_step,
    )


@twins.terms.register(GradientDescent)
def _(ours: GradientDescent, stage: Stage, unit: Params) -> Terms:
    stage, notes = _descending(stage, unit, estimated=ours.estimate_learning_rate != "never")
    if ours.keep == "best":
        stage, notes = _keeping(stage, "last"), (*notes, LAST)
    return Terms(stage, notes)


@twins.optimizer.register(GradientDescentLineSearch)
def _(ours: GradientDescentLineSearch, method: "Method", iterations: int, seed: int) -> None:
    method.SetOptimizerAsGradientDescentLineSearch(*_line_search(ours, method, iterations))


@twins.optimizer.register(ConjugateGradientLineSearch)
def _(ours: ConjugateGradientLineSearch, method: "Method", iterations: int, seed: int) -> None:
    method.SetOptimizerAsConjugateGradientLineSearch(*_line_search(ours, method, iterations))


@twins.terms.register(LineSearchDescent)
def _(ours: LineSearchDescent, stage: Stage, unit: Params) -> Terms:
    estimated = ours.estimate_learning_rate != "never"
    conjugate = isinstance(ours, ConjugateGradientLineSearch) and stage.scales == "shift"
    # A conjugate direction weighs slopes by their lengths, which no list of scales turns into motion.
    stage, notes = _descending(stage, unit, estimated=estimated or conjugate)
    if ours.keep == "best":
        stage = _keeping(stage, "itk")
        notes += ('SimpleITK returns a position that was reached from the best one, so keep = "itk"',)
    if conjugate and not estimated:
        notes += ("the learning rate is estimated",)
        changed = stage.optimizer.model_copy(update={"estimate_learning_rate": "once"})
        stage = _changed(stage, optimizer=changed)
    carried = not (estimated or conjugate) and len(stage.levels) > 1
    if carried:
        notes += (
            "SimpleITK's later levels begin with the last learning rate found, ours with the given one",
        )
    return Terms(stage, notes, alike=not carried, remembers=True)


@twins.optimizer.register(Powell)
def _(ours: Powell, method: "Method", iterations: int, seed: int) -> None:
    # Told N iterations, it makes N + 1 rounds.
    method.SetOptimizerAsPowell(
        iterations - 1, ours.line_iterations, ours.step_length, ours.step_tolerance, ours.value_tolerance
    )


@twins.terms.register(Powell)
def _(ours: Powell, stage: Stage, unit: Params) -> Terms:
    notes: tuple[str, ...] = ()
    if stage.scales == "shift":
        stage, notes = _changed(stage, scales=tuple(map(float, unit))), (LISTED,)
    if ours.keep == "best":
        stage, notes = _keeping(stage, "last"), (*notes, LAST)
    return Terms(stage, notes)


@twins.optimizer.register(Amoeba)
def _(ours: Amoeba, method: "Method", iterations: int, seed: int) -> None:
    method.SetOptimizerAsAmoeba(
        ours.simplex_delta, iterations, ours.parameters_tolerance, ours.value_tolerance
    )


@twins.terms.register(Amoeba)
def _(ours: Amoeba, stage: Stage, unit: Params) -> Terms:
    notes = ["SimpleITK counts evaluations where a level's iterations are changes of the simplex"]
    if stage.scales == "shift":
        stage = _changed(stage, scales=tuple(map(float, unit)))
        notes.append(LISTED)
    return Terms(stage, tuple(notes), alike=False)


@twins.optimizer.register(Exhaustive)
def _(ours: Exhaustive, method: "Method", iterations: int, seed: int) -> None:
    method.SetOptimizerAsExhaustive(list(ours.number_of_steps), ours.step_length)


@twins.terms.register(Exhaustive)
def _(ours: Exhaustive, stage: Stage, unit: Params) -> Terms:
    notes = ["SimpleITK tells every position of the lattice, regframe the best one so far"]
    if len(ours.number_of_steps) == 1:
        whole = ours.model_copy(update={"number_of_steps": ours.number_of_steps * len(unit)})
        stage = _changed(stage, optimizer=whole)
    if stage.scales == "shift":
        # Here scales multiply the step.
        stage = _changed(stage, scales=tuple(map(float, 1.0 / unit)))
        notes.append(LISTED)
    return Terms(stage, tuple(notes), alike=False)


@twins.optimizer.register(Lbfgsb)
def _(ours: Lbfgsb, method: "Method", iterations: int, seed: int) -> None:
    bounds = (
        SMALLEST if ours.lower is None else ours.lower,
        LARGEST if ours.upper is None else ours.upper,
    )
    method.SetOptimizerAsLBFGSB(
        ours.gradient_tolerance, iterations, ours.corrections, 2000, ours.convergence_factor, *bounds
    )


@twins.terms.register(Lbfgsb)
def _(ours: Lbfgsb, stage: Stage, unit: Params) -> Terms:
    if stage.scales == "shift" and not ours.lower is ours.upper is None:
        message = (
            "SimpleITK's L-BFGS-B bounds parameters, and these bounds are in pixels of motion. Leave "
            "`lower` and `upper` out, or write scales as a list of ones."
        )
        raise NoTwin(message)
    notes = ["SimpleITK's L-BFGS-B takes no scales and is an older version, so it goes another way"]
    if stage.gradient == "exact":
        notes.append("SimpleITK's slopes are central differences, regframe's those of what it interpolates")
    # One level a call: SimpleITK begins every level where the first one began.
    return Terms(stage, tuple(notes), alike=False, scaled=False, together=False)


@twins.held.register(OnePlusOne)
@twins.held.register(Powell)
def _(ours: OnePlusOne | Powell, stage: Stage, free: Mask) -> tuple[Stage, str]:
    return _scaled(stage, free, FAR)


@twins.held.register(Amoeba)
def _(ours: Amoeba, stage: Stage, free: Mask) -> tuple[Stage, str]:
    # It adds coordinates times scales, so that a larger scale would leave no digits to the others.
    return _scaled(stage, free, 1e10)


@twins.held.register(Exhaustive)
def _(ours: Exhaustive, stage: Stage, free: Mask) -> tuple[Stage, str]:
    kept = np.zeros(len(free), np.int64)
    # One number a free parameter, unless a single one has been written out for all.
    every = len(ours.number_of_steps) == len(free)
    kept[free] = np.array(ours.number_of_steps)[free] if every else ours.number_of_steps
    changed = ours.model_copy(update={"number_of_steps": tuple(map(int, kept))})
    return _changed(stage, optimizer=changed), "frozen parameters are told as 0 steps"


def _scaled(stage: Stage, free: Mask, far: float) -> tuple[Stage, str]:
    assert isinstance(stage.scales, tuple)
    scales = tuple(s if one else far for s, one in zip(stage.scales, free, strict=True))
    note = f"SimpleITK cannot freeze parameters in this search, so they are told the scale {far:g}"
    return _changed(stage, scales=scales), note


def _descending(stage: Stage, unit: Params, *, estimated: bool) -> tuple[Stage, tuple[str, ...]]:
    """A stage of slopes with ITK's slopes and scales: a step in pixels divides slopes by motion squared."""
    stage, notes = itk_slopes(stage)
    if stage.scales != "shift":
        return stage, notes
    if estimated:
        told = 'scales = "shift" is told as "physical-shift", beside which SimpleITK estimates learning rates'
        return _changed(stage, scales="physical-shift"), (*notes, told)
    return _changed(stage, scales=tuple(map(float, unit**2))), (*notes, LISTED)


def _keeping(stage: Stage, which: str) -> Stage:
    return _changed(stage, optimizer=stage.optimizer.model_copy(update={"keep": which}))


def _line_search(ours: LineSearchDescent, method: "Method", iterations: int) -> tuple[Any, ...]:
    return (
        ours.learning_rate,
        iterations,
        ours.convergence_minimum,
        ours.convergence_window,
        ours.lower_limit,
        ours.upper_limit,
        ours.line_tolerance,
        ours.line_iterations,
        _estimate(ours.estimate_learning_rate, method),
        ours.maximum_step,
    )


def _estimate(when: str, method: "Method") -> int:
    known: dict[str, int] = {
        "never": method.Never,
        "once": method.Once,
        "each-iteration": method.EachIteration,
    }
    return known[when]


def itk_slopes(stage: Stage) -> tuple[Stage, tuple[str, ...]]:
    """The stage with a slope of the moving image that ITK has, and a note where that is a change."""
    stage = _changed(stage, metric=twins.sloped(stage.metric))
    if stage.gradient != "exact":
        return stage, ()
    note = 'SimpleITK cannot take the slope of what it interpolates, so gradient = "filtered", its default'
    return _changed(stage, gradient="filtered"), (note,)


def _changed(stage: Stage, **changes: Any) -> Stage:
    return stage.model_copy(update=changes)
