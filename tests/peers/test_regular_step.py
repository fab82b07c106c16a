"""Regular step gradient descent against SimpleITK's, on SimpleITK's own values and slopes."""

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.optimizers.regular_step_gradient_descent import RegularStepGradientDescent
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.problems import run
from support.sitk_problems import SitkProblem, path

SIMILARITY = [1.03, 0.04, 1.5, -1.0]
ITERATIONS = 25
RATES = {
    "never": sitk.ImageRegistrationMethod.Never,
    "once": sitk.ImageRegistrationMethod.Once,
    "each-iteration": sitk.ImageRegistrationMethod.EachIteration,
}


def method(fixed, moving):
    theirs = peer.method(fixed, moving, "linear")
    theirs.SetMetricAsMeanSquares()
    return theirs


def settings(options):
    """SimpleITK's arguments for options of ours."""
    return (
        options.learning_rate,
        options.minimum_step,
        ITERATIONS,
        options.relaxation,
        options.gradient_tolerance,
        RATES[options.estimate_learning_rate],
        options.maximum_step,
    )


def cost(transform, start, scales):
    fixed = peer.pair((40, 48))[0]
    moving = fixed.with_values(np.roll(fixed.values, (2, -1), axis=(0, 1)))
    warp = Warp(transform, np.array(start), peer.frame(fixed))
    return SitkProblem(method(fixed, moving), fixed, moving, warp, scales)


def agree(told, steps):
    assert len(steps) == len(told)
    # Slopes read from a step of 1e8 are exact to the last bits; 1e-9 is the promise for gradient presets.
    np.testing.assert_allclose([s.params for s in steps], [t[0] for t in told], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose([s.value for s in steps], [t[1] for t in told], rtol=1e-9)


@pytest.mark.parametrize(
    ("transform", "start", "scales", "rate"),
    [
        (Translation(), [0.0, 0.0], [1.0, 1.0], 1.0),
        (Translation(), [0.5, -0.2], [1.005, 0.995], 0.7),
        (Similarity(), SIMILARITY, [1400.0, 1500.0, 1.0, 1.0], 0.8),
        (Similarity(), SIMILARITY, [1.0, 1.0, 1e-3, 1e-3], 0.5),
    ],
)
def test_walks_the_same_path(transform, start, scales, rate):
    problem = cost(transform, start, scales)
    optimizer = RegularStepGradientDescent(learning_rate=rate, keep="last")
    theirs = method(*problem.pair)
    theirs.SetOptimizerAsRegularStepGradientDescent(*settings(optimizer))
    theirs.SetOptimizerScales(scales)
    told, final = path(theirs, problem, start)

    steps, _ = run(optimizer, problem, start, iterations=ITERATIONS)

    agree(told, steps)
    np.testing.assert_allclose(steps[-1].params, final, rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize(
    ("options", "ours", "named"),
    [
        ({"learning_rate": 1.0, "minimum_step": 0.2}, "minimum_step", "Step too small"),
        ({"learning_rate": 1.0, "gradient_tolerance": 300.0}, "gradient_tolerance", "Gradient magnitude"),
    ],
)
def test_stops_at_the_same_iteration(options, ours, named):
    problem = cost(Translation(), [0.0, 0.0], [1.0, 1.0])
    optimizer = RegularStepGradientDescent(keep="last", **options)
    theirs = method(*problem.pair)
    theirs.SetOptimizerAsRegularStepGradientDescent(*settings(optimizer))
    theirs.SetOptimizerScales([1.0, 1.0])
    told, final = path(theirs, problem, [0.0, 0.0])

    steps, reason = run(optimizer, problem, [0.0, 0.0])

    assert ours in reason
    assert named in theirs.GetOptimizerStopConditionDescription()
    assert 0 < len(told) < ITERATIONS
    agree(told, steps)
    np.testing.assert_allclose(steps[-1].params, final, rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("when", ["once", "each-iteration"])
def test_estimates_the_same_learning_rates(when):
    start = SIMILARITY
    optimizer = RegularStepGradientDescent(estimate_learning_rate=when, maximum_step=1.5, keep="last")
    problem = cost(Similarity(), start, [1.0] * 4)
    theirs = method(*problem.pair)
    theirs.SetOptimizerAsRegularStepGradientDescent(*settings(optimizer))
    theirs.SetOptimizerScalesFromPhysicalShift()
    told, _ = path(theirs, problem, start)
    problem.scales = np.array(told[0][4])

    steps, _ = run(optimizer, problem, start, iterations=ITERATIONS)

    agree(told, steps)
    assert steps[0].size == pytest.approx(told[0][3], rel=1e-9)  # unrelaxed: the learning rate itself
