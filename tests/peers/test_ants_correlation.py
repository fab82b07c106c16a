"""The neighbourhood correlation against SimpleITK: values, valid points, derivatives."""

import numpy as np
import pytest

from regframe.catalog import TRANSFORMS
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.objectives import objective

NAME = "ants-correlation"


def placed(fixed, transform, size=0.02):
    family, frame = TRANSFORMS.build(transform), peer.frame(fixed)
    identity = family.identity(frame)
    return Warp(family, identity + size * np.random.default_rng(5).normal(size=len(identity)), frame)


@pytest.mark.parametrize("radius", [1, 3, 62])  # the last is wider than the image
@pytest.mark.parametrize("interpolator", ["linear", "bspline3"])
@pytest.mark.parametrize("masked", [False, True])
def test_value_and_valid_points(radius, interpolator, masked):
    fixed, moving = peer.pair(dtype=np.float64)
    if masked:
        y, x = np.indices(fixed.grid.shape)
        fixed, moving = fixed.with_mask(x + y > 20), moving.with_mask(x > 8)
    warp = placed(fixed, "affine", 0.05)
    theirs = peer.method(fixed, moving, interpolator)
    theirs.SetMetricAsANTSNeighborhoodCorrelation(radius)
    ours = objective(fixed, moving, warp, interpolator, metric={"type": NAME, "radius": radius})

    value = ours.values(warp.params[None])[0]

    expected, count = peer.value_and_count(theirs, fixed, moving, warp)
    assert int((ours.pairs(warp.params).weight > 0).sum()) == count
    assert value == pytest.approx(expected, rel=1e-9)  # both sides add and take away along running windows


def test_value_of_single_precision_images():
    """ITK rounds products of float32 intensities to float32; a metric here does not know of images."""
    fixed, moving = peer.pair(dtype=np.float32)
    warp = placed(fixed, "affine")
    theirs = peer.method(fixed, moving, "linear")
    theirs.SetMetricAsANTSNeighborhoodCorrelation(3)
    ours = objective(fixed, moving, warp, "linear", metric={"type": NAME, "radius": 3})

    value = ours.values(warp.params[None])[0]

    assert value == pytest.approx(peer.value_and_count(theirs, fixed, moving, warp)[0], rel=1e-5)


def test_value_in_space():
    fixed, moving = peer.pair((10, 12, 14), np.float64)
    warp = placed(fixed, "affine")
    theirs = peer.method(fixed, moving, "linear")
    theirs.SetMetricAsANTSNeighborhoodCorrelation(2)
    ours = objective(fixed, moving, warp, "linear", metric={"type": NAME, "radius": 2})

    value = ours.values(warp.params[None])[0]

    assert value == pytest.approx(peer.value_and_count(theirs, fixed, moving, warp)[0], rel=1e-9)


def test_constant_windows_score_as_itk_scores_them():
    fixed, moving = peer.pair(dtype=np.float64)
    values = moving.values.copy()
    values[:20] = 17.3
    moving = moving.with_values(values)
    warp = placed(fixed, "translation")
    theirs = peer.method(fixed, moving, "nearest")
    theirs.SetMetricAsANTSNeighborhoodCorrelation(2)
    ours = objective(fixed, moving, warp, "nearest", metric={"type": NAME, "radius": 2})

    value = ours.values(warp.params[None])[0]

    assert value == pytest.approx(peer.value_and_count(theirs, fixed, moving, warp)[0], rel=1e-9)


@pytest.mark.parametrize("gradient", ["filtered", "central"])
@pytest.mark.parametrize("transform", ["similarity", "affine"])
def test_derivative_of_itk(gradient, transform):
    fixed, moving = peer.pair(dtype=np.float64)
    warp = placed(fixed, transform)
    theirs = peer.method(fixed, moving, "bspline3")
    theirs.SetMetricAsANTSNeighborhoodCorrelation(3)
    theirs.SetMetricUseMovingImageGradientFilter(gradient == "filtered")
    metric = {"type": NAME, "radius": 3, "slope": "itk"}

    _, ours = objective(fixed, moving, warp, "bspline3", metric=metric, gradient=gradient).value_and_gradient(
        warp.params
    )

    expected = peer.derivative(theirs, fixed, moving, warp, 0.1)
    np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
