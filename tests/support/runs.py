"""The same preset run by SimpleITK, told part by part."""

from dataclasses import dataclass

import numpy as np
import SimpleITK as sitk

from regframe.image import Image
from regframe.optimizers.base import Optimizer
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
    ours = stage.optimizer
    if type(ours).__name__ == "OnePlusOne":
        shrink = -1.0 if ours.shrink is None else ours.shrink
        theirs.SetOptimizerAsOnePlusOneEvolutionary(
            stage.levels[0].iterations, ours.epsilon, ours.radius, ours.growth, shrink, seed
        )
        return
    tell_optimizer(theirs, ours, stage.levels[0].iterations, 0.0)


def tell_optimizer(
    theirs: sitk.ImageRegistrationMethod, ours: Optimizer, iterations: int, longest: float
) -> None:
    """Set SimpleITK's optimizer as one of ours; 0 leaves the largest step to SimpleITK."""
    kind = type(ours).__name__
    if kind == "Powell":  # told N iterations, it makes N + 1 rounds
        limits = (iterations - 1, ours.line_iterations, ours.step_length)
        theirs.SetOptimizerAsPowell(*limits, ours.step_tolerance, ours.value_tolerance)
    elif kind == "Amoeba":  # iterations are evaluations here
        tolerances = (ours.parameters_tolerance, ours.value_tolerance)
        theirs.SetOptimizerAsAmoeba(ours.simplex_delta, iterations, *tolerances)
    elif kind == "Exhaustive":
        theirs.SetOptimizerAsExhaustive(list(ours.number_of_steps), ours.step_length)
    elif kind == "Lbfgsb":
        theirs.SetOptimizerAsLBFGSB(
            ours.gradient_tolerance, iterations, ours.corrections, 2000, ours.convergence_factor
        )
    else:
        _descent(theirs, ours, iterations, longest)


def _descent(theirs: sitk.ImageRegistrationMethod, ours: Optimizer, iterations: int, longest: float) -> None:
    rate = (
        {"never": theirs.Never, "once": theirs.Once, "each-iteration": theirs.EachIteration}[
            ours.estimate_learning_rate
        ],
        longest,
    )
    if type(ours).__name__ == "RegularStepGradientDescent":
        limits = (ours.learning_rate, ours.minimum_step, iterations, ours.relaxation)
        theirs.SetOptimizerAsRegularStepGradientDescent(*limits, ours.gradient_tolerance, *rate)
        return
    limits = (ours.learning_rate, iterations, ours.convergence_minimum, ours.convergence_window)
    if type(ours).__name__ == "GradientDescent":
        theirs.SetOptimizerAsGradientDescent(*limits, *rate)
        return
    line = (ours.lower_limit, ours.upper_limit, ours.line_tolerance, ours.line_iterations)
    tell = {
        "GradientDescentLineSearch": theirs.SetOptimizerAsGradientDescentLineSearch,
        "ConjugateGradientLineSearch": theirs.SetOptimizerAsConjugateGradientLineSearch,
    }[type(ours).__name__]
    tell(*limits, *line, *rate)


def _scales(theirs: sitk.ImageRegistrationMethod, stage: Stage) -> None:
    if stage.scales == "shift":  # only where parameters are pixels already, or scales are not used
        return
    if isinstance(stage.scales, tuple):
        theirs.SetOptimizerScales(list(stage.scales))
        return
    {
        "physical-shift": theirs.SetOptimizerScalesFromPhysicalShift,
        "index-shift": theirs.SetOptimizerScalesFromIndexShift,
        "jacobian": theirs.SetOptimizerScalesFromJacobian,
    }[stage.scales]()
