"""The twins of the components that regframe ships, three lines each."""

from typing import TYPE_CHECKING, Any

import numpy as np

from regframe.geometry import Frame
from regframe.interpolators.bspline import BSpline
from regframe.interpolators.linear import Linear
from regframe.interpolators.nearest import Nearest
from regframe.metrics.base import Pairs
from regframe.metrics.correlation import Correlation
from regframe.metrics.mattes import Mattes
from regframe.metrics.mean_squares import MeanSquares
from regframe.optimizers.one_plus_one import OnePlusOne
from regframe.optimizers.regular_step_gradient_descent import RegularStepGradientDescent
from regframe.peer import twins
from regframe.peer.twins import Terms
from regframe.preset import Stage
from regframe.transforms.affine import Affine
from regframe.transforms.rigid import Rigid
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.types import Params

if TYPE_CHECKING:
    import SimpleITK as sitk

    from regframe.peer.twins import Method


@twins.metric.register(Correlation)
def _(ours: Correlation, method: "Method") -> None:
    method.SetMetricAsCorrelation()


@twins.metric.register(Mattes)
def _(ours: Mattes, method: "Method") -> None:
    method.SetMetricAsMattesMutualInformation(ours.bins)


@twins.counted.register(Mattes)
def _(ours: Mattes, pairs: Pairs) -> int:
    low, high = pairs.moving_range
    return int(np.count_nonzero((pairs.weight > 0) & (pairs.moving >= low) & (pairs.moving <= high)))


@twins.metric.register(MeanSquares)
def _(ours: MeanSquares, method: "Method") -> None:
    method.SetMetricAsMeanSquares()


@twins.interpolator.register(BSpline)
def _(ours: BSpline) -> str:
    return f"sitkBSpline{ours.order}" if ours.order else "sitkNearestNeighbor"


@twins.interpolator.register(Linear)
def _(ours: Linear) -> str:
    return "sitkLinear"


@twins.interpolator.register(Nearest)
def _(ours: Nearest) -> str:
    return "sitkNearestNeighbor"


@twins.transform.register(Affine)
def _(ours: Affine, frame: Frame) -> "sitk.Transform":
    return _centred("AffineTransform", frame, frame.dim)


@twins.transform.register(Rigid)
def _(ours: Rigid, frame: Frame) -> "sitk.Transform":
    return _centred("Euler2DTransform", frame)


@twins.transform.register(Similarity)
def _(ours: Similarity, frame: Frame) -> "sitk.Transform":
    return _centred("Similarity2DTransform", frame)


@twins.transform.register(Translation)
def _(ours: Translation, frame: Frame) -> "sitk.Transform":
    import SimpleITK as sitk

    return sitk.TranslationTransform(frame.dim)


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
            'scales = "shift" is told as a list, measured once at the start of the stage; epsilon is then '
            "compared with a norm in parameters, not in pixels, so a run that epsilon ends may end elsewhere"
        )
    if ours.variates != "wallace":
        notes.append(f'the draws of variates = "{ours.variates}" have no counterpart; SimpleITK uses its own')
    return Terms(stage, tuple(notes), alike=ours.variates == "wallace")


@twins.optimizer.register(RegularStepGradientDescent)
def _(ours: RegularStepGradientDescent, method: "Method", iterations: int, seed: int) -> None:
    estimates = {"never": method.Never, "once": method.Once, "each-iteration": method.EachIteration}
    method.SetOptimizerAsRegularStepGradientDescent(
        ours.learning_rate,
        ours.minimum_step,
        iterations,
        ours.relaxation,
        ours.gradient_tolerance,
        estimates[ours.estimate_learning_rate],
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
        notes += ('SimpleITK returns the last position, so keep = "last"',)
    return Terms(_changed(stage, optimizer=ours), notes)


def itk_slopes(stage: Stage) -> tuple[Stage, tuple[str, ...]]:
    """The stage with a slope of the moving image that ITK has, and a note where that is a change."""
    if stage.gradient != "exact":
        return stage, ()
    note = 'SimpleITK cannot take the slope of what it interpolates, so gradient = "filtered", its default'
    return _changed(stage, gradient="filtered"), (note,)


def _changed(stage: Stage, **changes: Any) -> Stage:
    return stage.model_copy(update=changes)


def _centred(name: str, frame: Frame, *arguments: int) -> "sitk.Transform":
    import SimpleITK as sitk

    theirs = getattr(sitk, name)(*arguments)
    theirs.SetCenter(frame.centre.tolist())
    made: sitk.Transform = theirs
    return made
