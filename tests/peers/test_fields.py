"""Displacement fields under both engines: maps, slopes, scales, steps, smoothing and levels."""

import numpy as np
import pytest

from regframe.engine.native import Native
from regframe.engine.setting import Placement, Setting, taken_up
from regframe.errors import NoTwin
from regframe.geometry import Frame, Grid
from regframe.peer import components
from regframe.peer.bench import Bench
from regframe.peer.crosscheck import crosscheck
from regframe.peer.simpleitk import SimpleITKEngine
from regframe.peer.whole import finished
from regframe.preset import Level, Stage, parse
from regframe.transforms.affine import Affine
from regframe.transforms.displacement_field import DisplacementField
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.runs import both

PLANE = Grid((20, 24), (1.2, 0.8), (30.0, -12.0), ((0.8, -0.6), (0.6, 0.8)))
SPACE = Grid(
    (12, 13, 14), (1.0, 1.1, 1.4), (3.0, 0.0, -5.0), ((0.6, 0.0, -0.8), (0.0, -1.0, 0.0), (0.8, 0.0, 0.6))
)
by_grid = pytest.mark.parametrize("grid", [PLANE, SPACE], ids=["plane", "space"])
LEVELS = [{"shrink": 2, "smooth": 1.0, "iterations": 3}, {"iterations": 3}]
EVEN = {
    "type": "gradient-descent",
    "estimate_learning_rate": "each-iteration",
    "maximum_step": 0.5,
    "keep": "last",
}
ONCE = {**EVEN, "estimate_learning_rate": "once"}
NEVER = {"type": "gradient-descent", "estimate_learning_rate": "never", "learning_rate": 0.7, "keep": "last"}
SEARCHED = {"type": "gradient-descent-line-search", "maximum_step": 1.0, "keep": "itk"}


def pair(grid):
    return peer.pair(grid.shape, np.float64, levels=0, grid=grid)


def affine(grid, seed):
    rng, dim = np.random.default_rng(seed), grid.dim
    matrix = np.eye(dim) + rng.uniform(-0.05, 0.05, (dim, dim))
    params = np.concatenate([matrix.ravel(), rng.uniform(-1.0, 1.0, dim)])
    return Warp(Affine(), params, Frame(grid, grid.centre + 2.0))


def preset(metric, optimizer, scales="physical-shift", **options):
    stage = {
        "transform": {"type": "displacement-field", **options},
        "interpolator": "linear",
        "metric": metric,
        "optimizer": optimizer,
        "scales": scales,
        "gradient": "filtered",
        "levels": LEVELS,
    }
    return parse({"name": "test", "stages": [stage]})


@by_grid
@pytest.mark.parametrize(
    "metric", ["mean-squares", "mattes", "demons", "ants-correlation", "itk-joint-histogram-mi"]
)
def test_maps_counts_and_slopes_are_the_same(grid, metric):
    fixed, moving = pair(grid)
    level = Level(shrink=2, smooth=0.7)
    stage = Stage(
        transform="displacement-field",
        interpolator="linear",
        metric=metric,
        optimizer="gradient-descent",
        levels=(level,),
    )
    params = np.random.default_rng(1).uniform(-0.8, 0.8, grid.size * grid.dim)
    warp = taken_up(Warp(stage.transform, params, Frame.about_centre(grid)), Setting(grid), level)
    bench = Bench(stage, 1, fixed, moving, warp, Setting(grid))

    lines = [ask(bench, "") for ask in (components.transform, components.count, components.slope)]

    # Mapped points, samples that count, shares of the steepest slope.
    assert [line.difference <= bound for line, bound in zip(lines, (1e-13, 0, 1e-11), strict=True)] == [
        True
    ] * 3


@by_grid
@pytest.mark.parametrize(
    ("metric", "optimizer", "scales"),
    [
        ("mattes", EVEN, "physical-shift"),
        ("mattes", ONCE, "index-shift"),
        ("mean-squares", EVEN, "index-shift"),
        ("demons", ONCE, "jacobian"),
        ("demons", NEVER, "listed"),
        ("demons", SEARCHED, "physical-shift"),
    ],
)
def test_both_engines_walk_alike(grid, metric, optimizer, scales):
    fixed, moving = pair(grid)
    scales = [1.0, 2.0, 1.5][: grid.dim] if scales == "listed" else scales

    ours, theirs = both(preset(metric, optimizer, scales), fixed, moving)

    assert [len(level.params) for level in ours.levels] == [len(level.params) for level in theirs.levels]
    assert ours.warp.params.any()
    for one, other in zip(ours.levels, theirs.levels, strict=True):
        np.testing.assert_allclose(one.params, other.params, rtol=0, atol=1e-9)


@by_grid
@pytest.mark.parametrize(
    ("metric", "variances"),
    [
        ("mattes", (1.75, 0.0)),
        ("mean-squares", (1.75, 0.0)),
        ("demons", (0.0, 0.5)),
        ("demons", (3.0, 1.0)),
        ("mattes", (0.2, 0.3)),
    ],
)
def test_steps_and_fields_are_smoothed_alike(grid, metric, variances):
    fixed, moving = pair(grid)
    options = {"update_variance": variances[0], "total_variance": variances[1]}
    chosen = preset(metric, NEVER if metric == "demons" else EVEN, "physical-shift", **options)

    ours, theirs = both(chosen, fixed, moving)

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


@by_grid
def test_the_size_of_slopes_is_told_where_it_matters(grid):
    """SimpleITK's slopes are N times as long here, which its estimate of a rate takes for longer steps."""
    pair_of_grid = pair(grid)
    chosen = preset("mean-squares", EVEN, update_variance=1.75, total_variance=0.5)
    sizeless = preset("mean-squares", EVEN, "shift", update_variance=1.75, total_variance=0.5)

    ours, theirs = both(chosen, *pair_of_grid)
    free = finished(Native(), sizeless, pair_of_grid)

    assert not theirs.provenance["alike"]
    assert any("the size of a slope matters" in note for note in theirs.provenance["notes"])
    apart = [np.abs(one.warp.params - theirs.warp.params).max() for one in (ours, free)]
    assert apart[1] < 0.1 * apart[0]


@by_grid
def test_axes_are_weighed_alike(grid):
    fixed, moving = pair(grid)
    weights = [0.0, 1.0, 0.5][: grid.dim]
    chosen = preset("mattes", EVEN).stages[0].model_copy(update={"weights": tuple(weights)})

    ours, theirs = both(parse({"stages": [chosen.model_dump(mode="json")]}), fixed, moving)

    assert not ours.warp.params[:: grid.dim].any()
    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


@by_grid
def test_a_field_is_searched_under_maps_that_stay(grid):
    fixed, moving = pair(grid)
    rng = np.random.default_rng(2)
    dim = grid.dim
    params = np.concatenate(
        [(np.eye(dim) + rng.uniform(-0.05, 0.05, (dim, dim))).ravel(), rng.uniform(-1, 1, dim)]
    )
    known = Warp(Affine(), params, Frame(grid, grid.centre + 2.0))

    ours, theirs = both(preset("mattes", EVEN), fixed, moving, Placement(moving_initial=known))

    np.testing.assert_allclose(ours.levels[-1].params, theirs.levels[-1].params, rtol=0, atol=1e-9)


@by_grid
def test_a_field_starts_from_an_affine_map(grid):
    fixed, moving = pair(grid)
    rng = np.random.default_rng(4)
    dim = grid.dim
    params = np.concatenate(
        [(np.eye(dim) + rng.uniform(-0.05, 0.05, (dim, dim))).ravel(), rng.uniform(-1, 1, dim)]
    )
    start = Warp(Affine(), params, Frame(grid, grid.centre + 2.0))

    ours, theirs = both(preset("mattes", EVEN), fixed, moving, Placement(start=start))

    corners = grid.corners()
    np.testing.assert_allclose(ours.start(corners), start(corners), rtol=0, atol=1e-12)
    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


def test_a_crosscheck_covers_fields():
    fixed, moving = pair(PLANE)

    report = crosscheck(preset("mattes", EVEN), fixed, moving)

    assert [line.what for line in report.lines if line.verdict == "differs"] == []
    assert report.corner < 1e-9


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"optimizer": "one-plus-one", "scales": "shift"}, "by gradient descent"),
        ({"optimizer": "regular-step-gradient-descent"}, "by gradient descent"),
        ({"metric": "correlation"}, "not the slope of its value"),
        ({"frozen": ["x[1,1]"]}, "weighs axes but not points"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_what_simpleitk_cannot_do_with_fields_is_told(changes, told):
    fixed, moving = pair(PLANE)
    chosen = preset("mattes", EVEN).stages[0].model_dump(mode="json") | changes

    with pytest.raises(NoTwin, match=told):
        finished(SimpleITKEngine(), parse({"stages": [chosen]}), (fixed, moving))


def test_smoothing_holds_the_border_still():
    field = DisplacementField(update_variance=1.0)
    frame = Frame.about_centre(PLANE)
    step = np.ones(PLANE.size * 2)

    moved = field.advance(np.zeros_like(step), step, frame).reshape(*PLANE.shape, 2)

    assert not moved[0].any()
    assert not moved[:, -1].any()
    np.testing.assert_allclose(moved[1:-1, 1:-1], 1.0, rtol=0, atol=1e-12)
