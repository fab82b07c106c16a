"""The B-spline transform against SimpleITK's: lattice, points, slopes, scales and short runs."""

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.engine.scales import coordinates
from regframe.geometry import Frame, Grid
from regframe.preset import Stage, parse
from regframe.transforms.bspline import BSpline
from regframe.transforms.itk import fixed_parameters
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.objectives import objective
from support.runs import both

TURNED = ((0.6, 0.0, -0.8), (0.0, -1.0, 0.0), (0.8, 0.0, 0.6))
GRIDS = {
    "camera": Grid.of_shape((24, 30)),
    "oblique": Grid((21, 25), (1.2, 0.7), (40.0, -3.0), ((0.8, -0.6), (0.6, 0.8))),
    "swapped": Grid((21, 25), (1.2, 0.7), (40.0, -3.0), ((0.0, 1.0), (-1.0, 0.0))),
    "volume": Grid((9, 10, 12), (1.1, 1.3, 2.0), (40.0, -3.0, 7.0), TURNED),
}
by_grid = pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
by_order = pytest.mark.parametrize("order", [2, 3])


def warp_over(grid, order, size=1.0):
    frame = Frame.about_centre(grid)
    family = BSpline(mesh=(3, 2, 4)[: grid.dim], order=order)
    count = len(family.identity(frame))
    return Warp(family, size * np.random.default_rng(order).uniform(-1.0, 1.0, count), frame)


@by_grid
@by_order
def test_the_lattice_is_laid_the_same(grid, order):
    warp = warp_over(grid, order)
    image = peer.pair(grid.shape, grid=grid)[0]

    theirs = sitk.BSplineTransformInitializer(peer.image(image), list(warp.transform.mesh), order)

    # Sums of numbers up to 100.
    np.testing.assert_allclose(
        fixed_parameters(warp.transform, warp.frame), theirs.GetFixedParameters(), rtol=0, atol=1e-13
    )


@by_grid
@by_order
def test_points_go_to_the_same_places(grid, order):
    warp = warp_over(grid, order)
    theirs = peer.transform(warp)
    rng = np.random.default_rng(9)
    points = grid.points(rng.uniform(-2.0, 1.0, (200, grid.dim)) + rng.random((200, grid.dim)) * grid.shape)

    wanted = np.array([theirs.TransformPoint(point) for point in points.tolist()])

    assert np.any(np.all(wanted == points, axis=1))
    np.testing.assert_allclose(warp(points), wanted, rtol=0, atol=1e-13)


@by_grid
@by_order
@pytest.mark.parametrize("metric", ["mattes", "mean-squares"])
def test_slopes_are_the_same(grid, order, metric):
    fixed, moving = peer.pair(grid.shape, np.float64, grid=grid)
    warp = warp_over(grid, order, 0.3)
    theirs = peer.method(fixed, moving, "linear")
    if metric == "mean-squares":
        theirs.SetMetricAsMeanSquares()

    got = objective(fixed, moving, warp, "linear", metric=metric, gradient="filtered").value_and_gradient(
        warp.params
    )[1]

    # A step so long that the start leaves no trace in its last bits.
    wanted = peer.derivative(theirs, fixed, moving, warp, 1e8 / np.abs(got).max())
    np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-10 * np.abs(wanted).max())


@pytest.mark.parametrize("kind", ["physical-shift", "index-shift"])
@pytest.mark.parametrize("grid", [GRIDS["camera"], GRIDS["volume"]], ids=["camera", "volume"])
def test_scales_are_estimated_the_same(kind, grid):
    fixed, moving = peer.pair(grid.shape, np.float64, grid=grid)
    frame, family = Frame.about_centre(grid), BSpline(mesh=(1,), order=3)
    count = len(family.identity(frame))
    warp = Warp(family, np.random.default_rng(3).uniform(-0.3, 0.3, count), frame)
    stage = Stage(
        transform=warp.transform,
        interpolator="linear",
        metric="mattes",
        optimizer="one-plus-one",
        scales=kind,
    )
    theirs, told = peer.method(fixed, moving, "linear"), []
    theirs.SetOptimizerAsGradientDescent(1e-12, 1, -1e300, 100, theirs.Never)
    if kind == "physical-shift":
        theirs.SetOptimizerScalesFromPhysicalShift()
    else:
        theirs.SetOptimizerScalesFromIndexShift()
    theirs.SetInitialTransform(peer.transform(warp), True)
    theirs.AddCommand(sitk.sitkIterationEvent, lambda: told.append(theirs.GetOptimizerScales()))
    theirs.Execute(peer.image(fixed), peer.image(moving))

    found, _ = coordinates(stage, warp.params, warp.frame, grid, grid)

    np.testing.assert_allclose(found.scales, told[0], rtol=1e-9)


@pytest.mark.parametrize("scales", ["physical-shift", "index-shift"])
def test_descent_over_two_levels(scales):
    fixed, moving = peer.pair((40, 48), np.float64)
    levels = [{"shrink": 2, "smooth": 1.0, "iterations": 5}, {"iterations": 5}]
    optimizer = {
        "type": "regular-step-gradient-descent",
        "minimum_step": 1e-5,
        "keep": "last",
        "estimate_learning_rate": "once",
        "maximum_step": 2.0,
    }
    stage = {
        "start": "identity",
        "transform": {"type": "bspline", "mesh": [3, 4]},
        "interpolator": "linear",
        "metric": {"type": "mattes", "bins": 32},
        "optimizer": optimizer,
        "scales": scales,
        "gradient": "filtered",
        "levels": levels,
    }
    chosen = parse({"name": "test", "seed": 7, "stages": [stage]})

    ours, theirs = both(chosen, fixed, moving)

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)
    np.testing.assert_allclose([p.value for p in ours.trace], [p.value for p in theirs.trace], rtol=1e-9)
