"""Mean squares and correlation against SimpleITK: values, valid points, derivatives."""

import numpy as np
import pytest

from regframe.catalog import TRANSFORMS
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.objectives import objective

METRICS = {"mean-squares": "SetMetricAsMeanSquares", "correlation": "SetMetricAsCorrelation"}
PARAMS = [1.04, 0.05, 2.3, -1.7]


@pytest.mark.parametrize("metric", METRICS)
@pytest.mark.parametrize("interpolator", ["nearest", "linear", "bspline3"])
@pytest.mark.parametrize("masked", [False, True])
def test_value_and_valid_points(metric, interpolator, masked):
    fixed, moving = peer.pair(dtype=np.float64)
    if masked:
        y, x = np.indices(fixed.grid.shape)
        fixed, moving = fixed.with_mask(x + y > 20), moving.with_mask(x > 8)
    warp = Warp(TRANSFORMS.build("similarity"), np.array(PARAMS), peer.frame(fixed))
    theirs = peer.method(fixed, moving, interpolator)
    getattr(theirs, METRICS[metric])()
    ours = objective(fixed, moving, warp, interpolator, metric=metric)

    value = ours.values(warp.params[None])[0]

    expected, count = peer.value_and_count(theirs, fixed, moving, warp)
    assert int((ours.pairs(warp.params).weight > 0).sum()) == count
    assert value == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("metric", METRICS)
@pytest.mark.parametrize("gradient", ["filtered", "central"])
@pytest.mark.parametrize("transform", ["similarity", "affine"])
def test_derivative_with_the_gradients_of_itk(metric, gradient, transform):
    fixed, moving = peer.pair(dtype=np.float64)
    family, frame = TRANSFORMS.build(transform), peer.frame(fixed)
    params = family.identity(frame) + 0.02 * np.random.default_rng(5).normal(size=len(family.identity(frame)))
    warp = Warp(family, params, frame)
    theirs = peer.method(fixed, moving, "bspline3")
    getattr(theirs, METRICS[metric])()
    theirs.SetMetricUseMovingImageGradientFilter(gradient == "filtered")

    _, ours = objective(fixed, moving, warp, "bspline3", metric=metric, gradient=gradient).value_and_gradient(
        params
    )

    rate = 1e-4 if metric == "mean-squares" else 0.1
    expected = peer.derivative(theirs, fixed, moving, warp, rate)
    np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("metric", METRICS)
def test_exact_derivative_is_the_slope_of_the_value(metric):
    fixed, moving = peer.pair(dtype=np.float64, levels=0)
    y, x = np.indices(fixed.grid.shape)
    fixed = fixed.with_mask((x > 9) & (x < 50) & (y > 9) & (y < 38))
    family, frame = TRANSFORMS.build("affine"), peer.frame(fixed)
    params = family.identity(frame) + 0.02 * np.random.default_rng(5).normal(size=6)
    ours = objective(fixed, moving, Warp(family, params, frame), "bspline3", metric=metric)

    _, slope = ours.value_and_gradient(params)

    step = 1e-4 / family.shift(params, frame)
    ahead, behind = (ours.values(params + sign * np.diag(step)) for sign in (1, -1))
    differences = (ahead - behind) / (2 * step)
    np.testing.assert_allclose(slope, differences, rtol=0, atol=1e-6 * np.abs(differences).max())
