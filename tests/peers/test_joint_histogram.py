"""The joint histogram metrics against SimpleITK: values, valid points, derivatives."""

import numpy as np
import pytest

from regframe.catalog import METRICS, TRANSFORMS
from regframe.kernels.discrete import bessel
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.objectives import objective

PARAMS = [1.04, 0.05, 2.3, -1.7]
NAME = "itk-joint-histogram-mi"


def similarity(fixed):
    return Warp(TRANSFORMS.build("similarity"), np.array(PARAMS), peer.frame(fixed))


@pytest.mark.parametrize(("bins", "variance"), [(20, 1.5), (6, 0.0), (33, 0.4), (48, 7.0)])
@pytest.mark.parametrize("interpolator", ["linear", "bspline3"])
@pytest.mark.parametrize("masked", [False, True])
def test_value_and_valid_points(bins, variance, interpolator, masked):
    fixed, moving = peer.pair(dtype=np.float64, levels=0)
    if masked:
        y, x = np.indices(fixed.grid.shape)
        fixed, moving = fixed.with_mask(x + y > 20), moving.with_mask(x > 8)
    warp = similarity(fixed)
    theirs = peer.method(fixed, moving, interpolator)
    theirs.SetMetricAsJointHistogramMutualInformation(bins, variance)
    metric = {"type": NAME, "bins": bins, "variance": variance}
    ours = objective(fixed, moving, warp, interpolator, metric=metric)

    value = ours.values(warp.params[None])[0]

    expected, count = peer.value_and_count(theirs, fixed, moving, warp)
    pairs = ours.pairs(warp.params)
    low, high = pairs.moving_range
    # ITK counts the pairs that have a slope.
    assert int(((pairs.weight > 0) & (pairs.moving >= low) & (pairs.moving <= high)).sum()) == count
    assert value == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_value_on_whole_grey_levels(dtype):
    """Grey levels on bin edges go to the bin that ITK takes."""
    fixed, moving = peer.pair(dtype=dtype)
    warp = similarity(fixed)
    theirs = peer.method(fixed, moving, "linear")
    theirs.SetMetricAsJointHistogramMutualInformation(56, 1.5)

    value = objective(fixed, moving, warp, "linear", metric={"type": NAME, "bins": 56}).values(
        warp.params[None]
    )[0]

    assert value == pytest.approx(peer.value_and_count(theirs, fixed, moving, warp)[0], rel=1e-12)


@pytest.mark.parametrize("gradient", ["filtered", "central"])
@pytest.mark.parametrize("transform", ["similarity", "affine"])
def test_derivative_of_itk(gradient, transform):
    fixed, moving = peer.pair(dtype=np.float64, levels=0)
    family, frame = TRANSFORMS.build(transform), peer.frame(fixed)
    params = family.identity(frame) + 0.02 * np.random.default_rng(5).normal(size=len(family.identity(frame)))
    warp = Warp(family, params, frame)
    theirs = peer.method(fixed, moving, "bspline3")
    theirs.SetMetricAsJointHistogramMutualInformation(20, 1.5)
    theirs.SetMetricUseMovingImageGradientFilter(gradient == "filtered")

    _, ours = objective(
        fixed, moving, warp, "bspline3", metric={"type": NAME, "slope": "itk"}, gradient=gradient
    ).value_and_gradient(params)

    expected = peer.derivative(theirs, fixed, moving, warp, 10.0)
    np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_constant_image_has_no_value():
    fixed, moving = peer.pair(dtype=np.float64)
    flat = moving.with_values(np.full_like(moving.values, 3.0))
    warp = similarity(fixed)
    theirs = peer.method(fixed, flat, "linear")
    theirs.SetMetricAsJointHistogramMutualInformation(20, 1.5)
    ours = objective(fixed, flat, warp, "linear", metric=NAME)

    value = ours.stage.metric.value(ours.pairs(warp.params))

    assert value == float("inf")
    assert peer.value_and_count(theirs, fixed, flat, warp) == (np.finfo(np.float64).max, 0)


def test_true_marginals_give_a_mutual_information():
    """Without smoothing, on whole bins, the value is the plain one of the counts."""
    rng = np.random.default_rng(3)
    fixed, moving = peer.pair(dtype=np.float64)
    levels = rng.integers(0, 12, (2, *fixed.grid.shape)).astype(np.float64)
    levels[1] = np.where(rng.random(fixed.grid.shape) < 0.6, levels[0] * 3 % 12, levels[1])
    metric = METRICS.build({"type": "joint-histogram-mi", "bins": 16, "variance": 0.0})
    family, frame = TRANSFORMS.build("translation"), peer.frame(fixed)
    warp = Warp(family, family.identity(frame), frame)
    pair = fixed.with_values(levels[0]), moving.with_values(levels[1])

    value = objective(*pair, warp, "linear", metric=metric).values(warp.params[None])[0]

    counts = np.histogram2d(levels[0].ravel(), levels[1].ravel(), 12)[0] / levels[0].size
    independent = np.outer(counts.sum(axis=1), counts.sum(axis=0))
    some = counts > 0
    assert value == pytest.approx(-np.sum(counts[some] * np.log(counts[some] / independent[some])), rel=1e-12)


@pytest.mark.parametrize("order", range(6))
@pytest.mark.parametrize("at", [0.3, 1.5, 3.7, 3.8, 20.0])
def test_bessel_functions_are_those_of_scipy(order, at):
    from scipy.special import iv

    # The polynomials of Abramowitz and Stegun are good to 2e-7; the recurrence adds a little.
    assert bessel(order, at) == pytest.approx(iv(order, at), rel=1e-6)
