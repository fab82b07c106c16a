"""Maps before and after the searched one, and another grid of samples, under both engines."""

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.engine.setting import Placement
from regframe.geometry import Frame, Grid
from regframe.peer import crosscheck as checks
from regframe.preset import parse
from regframe.transforms.affine import Affine
from regframe.transforms.bspline import BSpline
from regframe.transforms.rigid import Rigid
from regframe.transforms.similarity import Similarity
from regframe.transforms.warp import Chain, Warp
from support import sitk as peer
from support.runs import both

OBLIQUE = Grid((40, 48), (1.2, 0.8), (30.0, -12.0), ((0.8, -0.6), (0.6, 0.8)))
SPACE = Grid(
    (14, 18, 20), (1.0, 1.1, 1.4), (3.0, 0.0, -5.0), ((0.6, 0.0, -0.8), (0.0, -1.0, 0.0), (0.8, 0.0, 0.6))
)
GRIDS = {"plane": Grid.of_shape((40, 48)), "oblique": OBLIQUE, "space": SPACE}
by_grid = pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
LEVELS = [{"shrink": 2, "smooth": 1.0, "iterations": 12}, {"shrink": 1, "iterations": 12}]
EVOLUTION = {"type": "one-plus-one", "radius": 0.7, "epsilon": 1e-8}
DESCENT = {
    "type": "regular-step-gradient-descent",
    "learning_rate": 0.3,
    "minimum_step": 1e-5,
    "keep": "last",
}


def stage(dim, **changes):
    count = {2: 4, 3: 7}[dim]
    scales = [400.0, 400.0, 1.0, 1.0] if dim == 2 else [400.0] * 3 + [1.0] * 3 + [400.0]
    return {
        "start": "centres",
        "transform": "similarity",
        "interpolator": "linear",
        "metric": {"type": "mattes", "bins": 24},
        "optimizer": EVOLUTION,
        "scales": scales[:count],
        "gradient": "filtered",
        "levels": LEVELS,
        **changes,
    }


def preset(*stages):
    return parse({"name": "test", "seed": 5, "stages": list(stages)})


def off_centre(grid, size):
    """An affine map of some motion, about a point that is not the grid's middle."""
    dim = grid.dim
    rng = np.random.default_rng(11)
    params = np.concatenate([(np.eye(dim) + size * rng.uniform(-0.1, 0.1, (dim, dim))).ravel()])
    params = np.concatenate([params, size * rng.uniform(-2.0, 2.0, dim)])
    return Warp(Affine(), params, Frame(grid, grid.centre + rng.uniform(-6.0, 6.0, dim)))


def turned(grid):
    dim = grid.dim
    params = np.array([0.06, 1.3, -0.8]) if dim == 2 else np.array([0.04, -0.03, 0.05, 0.7, -0.5, 0.6])
    return Warp(Rigid(), params, Frame(grid, grid.centre + 3.0))


def domain(grid):
    """A coarser lattice over the grid's middle, along other axes."""
    dim = grid.dim
    cos, sin = np.cos(0.2), np.sin(0.2)
    rows = np.eye(dim)
    rows[:2, :2] = [[cos, -sin], [sin, cos]]
    found = Grid(
        tuple(n - 6 for n in grid.shape), tuple(1.1 * s for s in grid.spacing), (0.0,) * dim, grid.direction
    )
    rows = rows @ np.array(grid.direction)
    found = Grid(found.shape, found.spacing, found.origin, tuple(tuple(map(float, r)) for r in rows))
    origin = grid.centre - found.centre
    return Grid(found.shape, found.spacing, tuple(map(float, origin)), found.direction)


PLACES = {
    "moving": lambda grid: Placement(moving_initial=off_centre(grid, 1.0)),
    "moving chain": lambda grid: Placement(moving_initial=turned(grid) @ off_centre(grid, 0.5)),
    "fixed": lambda grid: Placement(fixed_initial=turned(grid)),
    "domain": lambda grid: Placement(domain=domain(grid)),
    "all": lambda grid: Placement(
        start=Warp(Rigid(), turned(grid).params * 0.3, Frame.about_centre(grid)),
        moving_initial=off_centre(grid, 1.0),
        fixed_initial=turned(grid),
        domain=domain(grid),
    ),
}
by_place = pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)


@by_grid
@by_place
@pytest.mark.parametrize("optimizer", [EVOLUTION, DESCENT], ids=["evolution", "descent"])
def test_both_engines_walk_alike(grid, place, optimizer):
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    levels = [{**level, "iterations": 12 if optimizer is EVOLUTION else 4} for level in LEVELS]

    ours, theirs = both(
        preset(stage(grid.dim, optimizer=optimizer, levels=levels)), fixed, moving, place(grid)
    )

    np.testing.assert_allclose(ours.levels[-1].params, theirs.levels[-1].params, rtol=0, atol=1e-9)
    np.testing.assert_allclose([p.value for p in ours.trace], [p.value for p in theirs.trace], rtol=1e-10)
    corners = grid.corners()
    np.testing.assert_allclose(ours.warp(corners), theirs.warp(corners), rtol=0, atol=1e-8)


@by_grid
def test_the_result_is_the_whole_way_between_the_images(grid):
    """Values compared in the last level are those that meet under the result's warp."""
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    place = PLACES["all"](grid)

    ours, _ = both(preset(stage(grid.dim)), fixed, moving, place)

    searched = Warp(Similarity(), np.array(ours.levels[-1].params), ours.warp.warps[-2].frame)
    points = place.domain.points(place.domain.all_indices())
    at_fixed = place.fixed_initial(points)
    wanted = place.moving_initial(searched(points))
    np.testing.assert_allclose(ours.warp(at_fixed), wanted, rtol=0, atol=1e-9)


@pytest.mark.parametrize("scales", ["physical-shift", "index-shift", "jacobian"])
@by_grid
def test_scales_are_estimated_behind_the_moving_initial(grid, scales):
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    descent = {**DESCENT, "estimate_learning_rate": "once", "maximum_step": 2 * min(grid.spacing)}
    levels = [{**level, "iterations": 4} for level in LEVELS]
    place = Placement(moving_initial=off_centre(grid, 1.0), fixed_initial=turned(grid))

    ours, theirs = both(
        preset(stage(grid.dim, optimizer=descent, scales=scales, levels=levels)), fixed, moving, place
    )

    np.testing.assert_allclose(ours.levels[-1].params, theirs.levels[-1].params, rtol=0, atol=1e-9)


@pytest.mark.parametrize("sampling", ["regular", "random"])
@pytest.mark.parametrize("masked", [False, True])
def test_sparse_samples_of_a_domain(sampling, masked):
    fixed, moving = peer.pair(OBLIQUE.shape, grid=OBLIQUE)
    if masked:
        y, x = np.indices(OBLIQUE.shape)
        fixed = fixed.with_mask((x - 24) ** 2 + (y - 20) ** 2 < 200)
    levels = [{**level, "sampling": sampling, "fraction": 0.5} for level in LEVELS]

    ours, theirs = both(preset(stage(2, levels=levels)), fixed, moving, PLACES["all"](OBLIQUE))

    np.testing.assert_allclose(ours.levels[-1].params, theirs.levels[-1].params, rtol=0, atol=1e-9)


@by_grid
def test_a_composed_stage_keeps_the_map_before(grid):
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    first = stage(grid.dim, transform="translation", scales=[1.0] * grid.dim)
    scales = [400.0] * grid.dim**2 + [1.0] * grid.dim

    ours, theirs = both(
        preset(first, stage(grid.dim, start="compose", transform="affine", scales=scales)), fixed, moving
    )

    assert [type(warp.transform).__name__ for warp in ours.warp.warps] == ["Translation", "Affine"]
    np.testing.assert_array_equal(ours.warp.warps[0].params, ours.levels[1].params)
    np.testing.assert_allclose(ours.levels[-1].params, theirs.levels[-1].params, rtol=0, atol=1e-9)


def test_a_bent_map_after_the_searched_one():
    """ITK has no slope behind a spline, so a search by values."""
    grid = GRIDS["plane"]
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    frame = Frame.about_centre(grid)
    bent = Warp(BSpline(mesh=(3,)), np.random.default_rng(2).uniform(-1.5, 1.5, 2 * 36), frame)

    ours, theirs = both(preset(stage(2)), fixed, moving, Placement(moving_initial=bent))

    np.testing.assert_allclose(ours.levels[-1].params, theirs.levels[-1].params, rtol=0, atol=1e-9)


def test_the_centre_is_not_overwritten():
    """SimpleITK's own call moves the centre of the searched map, and with it the map."""
    grid = GRIDS["oblique"]
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    place = Placement(start=turned(grid), moving_initial=off_centre(grid, 1.0))
    chosen = preset(stage(2, levels=[{"iterations": 1}]))
    bare = sitk.ImageRegistrationMethod()
    bare.SetMetricAsMattesMutualInformation(24)
    bare.SetInterpolator(sitk.sitkLinear)
    bare.SetOptimizerAsGradientDescent(1e-300, 1)
    searched = peer.transform(Warp(Similarity(), np.array([1.0, *turned(grid).params]), turned(grid).frame))
    bare.SetInitialTransform(searched, True)
    bare.SetMovingInitialTransform(peer.transform(place.moving_initial))

    bare.Execute(peer.image(fixed), peer.image(moving))
    ours, theirs = both(chosen, fixed, moving, place)

    centre = sitk.Similarity2DTransform(searched).GetCenter()
    np.testing.assert_array_equal(centre, place.moving_initial.frame.centre)
    assert abs(bare.GetMetricValue() - ours.levels[0].start_value) > 1e-4
    np.testing.assert_allclose(ours.levels[0].start_value, theirs.levels[0].start_value, rtol=1e-12)


@pytest.mark.parametrize("place", [PLACES["all"], PLACES["moving chain"]], ids=["all", "chain"])
@pytest.mark.parametrize("grid", [GRIDS["oblique"], GRIDS["space"]], ids=["oblique", "space"])
def test_a_crosscheck_covers_what_stays(grid, place):
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)

    report = checks.crosscheck(preset(stage(grid.dim)), fixed, moving, start=place(grid))

    assert [line.what for line in report.lines if line.verdict == "differs"] == []
    assert report.corner < 1e-9


def test_chains_join_without_nesting():
    grid = GRIDS["plane"]
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    known = turned(grid) @ off_centre(grid, 0.5)

    ours, _ = both(preset(stage(2)), fixed, moving, Placement(moving_initial=known))

    assert isinstance(ours.warp, Chain)
    assert all(isinstance(warp, Warp) for warp in ours.warp.warps)
    assert len(ours.warp.warps) == 3
