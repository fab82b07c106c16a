"""The same preset run by SimpleITK, told part by part."""

from dataclasses import dataclass

import numpy as np
import SimpleITK as sitk

from regframe.image import Image
from regframe.preset import Preset, Stage
from regframe.transforms.warp import Warp
from support import sitk as peer

METRICS = {
    "Mattes": lambda run, metric: run.SetMetricAsMattesMutualInformation(metric.bins),
    "MeanSquares": lambda run, _: run.SetMetricAsMeanSquares(),
    "Correlation": lambda run, _: run.SetMetricAsCorrelation(),
}


@dataclass
class Walk:
    """What SimpleITK tells at each iteration: parameters and value; and where it ends."""

    params: list[np.ndarray]
    values: list[float]
    final: np.ndarray
    stop: str


def run(preset: Preset, fixed: Image, moving: Image, start: Warp) -> Walk:
    """SimpleITK on the first stage of a preset, from a given start."""
    stage = preset.stages[0]
    name = getattr(stage.interpolator, "order", None)
    interpolator = f"bspline{name}" if name else type(stage.interpolator).__name__.lower()
    theirs = peer.method(fixed, moving, interpolator)
    METRICS[type(stage.metric).__name__](theirs, stage.metric)
    _sampling(theirs, stage, preset.seed)
    theirs.SetShrinkFactorsPerLevel([level.shrink for level in stage.levels])
    theirs.SetSmoothingSigmasPerLevel([level.smooth for level in stage.levels])
    theirs.SetMetricUseMovingImageGradientFilter(stage.gradient == "filtered")
    _optimizer(theirs, stage, preset.seed)
    _scales(theirs, stage)
    moved = peer.transform(start)
    theirs.SetInitialTransform(moved, True)
    walk = Walk([], [], np.empty(0), "")

    def tell() -> None:
        walk.params.append(np.array(theirs.GetOptimizerPosition()))
        walk.values.append(theirs.GetMetricValue())

    theirs.AddCommand(sitk.sitkIterationEvent, tell)
    theirs.Execute(peer.image(fixed), peer.image(moving))
    walk.final = np.array(moved.GetParameters())
    walk.stop = theirs.GetOptimizerStopConditionDescription()
    return walk


def _sampling(theirs: sitk.ImageRegistrationMethod, stage: Stage, seed: int) -> None:
    kinds = {"all": theirs.NONE, "regular": theirs.REGULAR, "random": theirs.RANDOM}
    theirs.SetMetricSamplingStrategy(kinds[stage.levels[0].sampling])
    theirs.SetMetricSamplingPercentagePerLevel([level.fraction for level in stage.levels], seed)


def _optimizer(theirs: sitk.ImageRegistrationMethod, stage: Stage, seed: int) -> None:
    ours, iterations = stage.optimizer, stage.levels[0].iterations
    if type(ours).__name__ == "OnePlusOne":
        shrink = -1.0 if ours.shrink is None else ours.shrink
        theirs.SetOptimizerAsOnePlusOneEvolutionary(
            iterations, ours.epsilon, ours.radius, ours.growth, shrink, seed
        )
        return
    estimates = {"never": theirs.Never, "once": theirs.Once, "each-iteration": theirs.EachIteration}
    theirs.SetOptimizerAsRegularStepGradientDescent(
        ours.learning_rate,
        ours.minimum_step,
        iterations,
        ours.relaxation,
        ours.gradient_tolerance,
        estimates[ours.estimate_learning_rate],
        0.0,
    )


def _scales(theirs: sitk.ImageRegistrationMethod, stage: Stage) -> None:
    if isinstance(stage.scales, tuple):
        theirs.SetOptimizerScales(list(stage.scales))
        return
    {
        "physical-shift": theirs.SetOptimizerScalesFromPhysicalShift,
        "index-shift": theirs.SetOptimizerScalesFromIndexShift,
        "jacobian": theirs.SetOptimizerScalesFromJacobian,
    }[stage.scales]()
