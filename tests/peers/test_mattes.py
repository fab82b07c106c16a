"""Mattes mutual information against SimpleITK: values, valid points, derivatives."""

import numpy as np
import pytest

from regframe.catalog import TRANSFORMS
from regframe.engine.objective import Objective
from regframe.geometry import Grid
from regframe.image import Image
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.objectives import SPLINES, objective

TURN = 0.3
OBLIQUE = ((np.cos(TURN), -np.sin(TURN)), (np.sin(TURN), np.cos(TURN)))
SIMILARITIES = [
    (1.0, 0.0, 0.0, 0.0),
    (1.0, 0.0, 3.0, -2.0),
    (1.04, 0.05, 2.3, -1.7),
    (0.9, -0.2, 5.1, 4.4),
    (1.2, 0.6, -20.0, 11.0),
]


def valid(ours: Objective, params: np.ndarray) -> int:
    pairs = ours.pairs(params)
    low, high = pairs.moving_range
    return int(np.sum((pairs.weight > 0) & (pairs.moving >= low) & (pairs.moving <= high)))


def agree(fixed: Image, moving: Image, warp: Warp, interpolator: str) -> None:
    theirs = peer.method(fixed, moving, interpolator)
    expected, count = peer.value_and_count(theirs, fixed, moving, warp)
    ours = objective(fixed, moving, warp, interpolator)

    value = ours.values(warp.params[None])[0]

    assert valid(ours, warp.params) == count
    assert value == pytest.approx(expected, rel=1e-12, abs=1e-14)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("interpolator", ["nearest", "linear", *SPLINES])
@pytest.mark.parametrize("params", SIMILARITIES)
def test_value_of_whole_grey_levels_in_the_plane(params, interpolator, dtype):
    fixed, moving = peer.pair(dtype=dtype)

    agree(
        fixed, moving, Warp(TRANSFORMS.build("similarity"), np.array(params), peer.frame(fixed)), interpolator
    )


@pytest.mark.parametrize("interpolator", ["linear", "bspline3"])
@pytest.mark.parametrize("spacing", [(1.0, 1.0), (0.7, 1.3)])
def test_value_on_oblique_grids(interpolator, spacing):
    grid = Grid((48, 60), spacing, (3.5, -7.25), OBLIQUE)
    fixed, moving = peer.pair(grid=grid)

    warp = Warp(TRANSFORMS.build("affine"), np.array([1.05, 0.02, -0.04, 0.97, 2.1, -3.3]), peer.frame(fixed))

    agree(fixed, moving, warp, interpolator)


@pytest.mark.parametrize("interpolator", ["linear", "bspline3"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_value_in_space(interpolator, dtype):
    grid = Grid(
        (14, 22, 26), (1.0, 1.2, 2.0), (0.0, 5.0, -3.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    )
    fixed, moving = peer.pair((14, 22, 26), dtype, grid=grid)
    matrix = np.eye(3) + 0.03 * np.random.default_rng(3).normal(size=(3, 3))

    warp = Warp(TRANSFORMS.build("affine"), np.append(matrix.ravel(), [1.3, -2.2, 0.7]), peer.frame(fixed))

    agree(fixed, moving, warp, interpolator)


@pytest.mark.parametrize("which", ["fixed", "moving", "both"])
@pytest.mark.parametrize("interpolator", ["linear", "bspline3"])
def test_value_under_masks(which, interpolator):
    fixed, moving = peer.pair()
    y, x = np.indices(fixed.grid.shape)
    if which in ("fixed", "both"):
        fixed = fixed.with_mask((x - 25) ** 2 + (y - 20) ** 2 < 300)
    if which in ("moving", "both"):
        moving = moving.with_mask((x > 8) & (y < 40))

    warp = Warp(TRANSFORMS.build("similarity"), np.array([1.04, 0.05, 2.3, -1.7]), peer.frame(fixed))

    agree(fixed, moving, warp, interpolator)


@pytest.mark.parametrize("bins", [8, 20, 64])
def test_value_for_other_numbers_of_bins(bins):
    fixed, moving = peer.pair()
    warp = Warp(TRANSFORMS.build("similarity"), np.array([1.04, 0.05, 2.3, -1.7]), peer.frame(fixed))
    theirs = peer.method(fixed, moving, "bspline3")
    theirs.SetMetricAsMattesMutualInformation(bins)
    theirs.SetInitialTransform(peer.transform(warp))

    ours = objective(fixed, moving, warp, "bspline3", metric={"type": "mattes", "bins": bins})

    expected = theirs.MetricEvaluate(peer.image(fixed), peer.image(moving))
    assert ours.values(warp.params[None])[0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("transform", ["translation", "rigid", "similarity", "affine"])
@pytest.mark.parametrize("interpolator", ["linear", "bspline3"])
@pytest.mark.parametrize("gradient", ["filtered", "central"])
def test_derivative_with_the_gradients_of_itk(transform, interpolator, gradient):
    fixed, moving = peer.pair()
    family, frame = TRANSFORMS.build(transform), peer.frame(fixed)
    params = family.identity(frame) + np.random.default_rng(5).normal(size=len(family.identity(frame))) * 0.02
    warp = Warp(family, params, frame)
    theirs = peer.method(fixed, moving, interpolator)
    theirs.SetMetricUseMovingImageGradientFilter(gradient == "filtered")

    _, ours = objective(fixed, moving, warp, interpolator, gradient=gradient).value_and_gradient(params)

    expected = peer.derivative(theirs, fixed, moving, warp, 0.1)
    np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("interpolator", ["linear", "bspline3", "bspline5"])
@pytest.mark.parametrize("transform", ["translation", "similarity", "affine"])
def test_exact_derivative_is_the_slope_of_the_value(interpolator, transform):
    fixed, moving = peer.pair(dtype=np.float64, levels=0)
    y, x = np.indices(fixed.grid.shape)
    # Interior samples only: one that crosses the border is a jump, not a slope.
    fixed = fixed.with_mask((x > 9) & (x < 50) & (y > 9) & (y < 38))
    family, frame = TRANSFORMS.build(transform), peer.frame(fixed)
    params = family.identity(frame) + np.random.default_rng(5).normal(size=len(family.identity(frame))) * 0.02
    ours = objective(fixed, moving, Warp(family, params, frame), interpolator)

    _, slope = ours.value_and_gradient(params)

    step = 1e-5 / family.shift(params, frame)
    ahead, behind = (ours.values(params + sign * np.diag(step)) for sign in (1, -1))
    differences = (ahead - behind) / (2 * step)
    # A linear surface has kinks at pixel borders, which some samples cross within the step.
    bound = 1e-3 if interpolator == "linear" else 1e-6
    np.testing.assert_allclose(slope, differences, rtol=0, atol=bound * np.abs(differences).max())
