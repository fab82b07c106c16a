"""B-splines whose mesh grows from level to level, under both engines."""

import csv

import numpy as np
import pytest

from regframe.errors import NoTwin, PresetError
from regframe.geometry import Grid
from regframe.peer.simpleitk import SimpleITKEngine
from regframe.peer.whole import finished
from regframe.preset import parse
from regframe.transforms.itk import fixed_parameters
from support import sitk as peer
from support.runs import both

GRIDS = {
    "plane": Grid.of_shape((40, 48)),
    "oblique": Grid((40, 48), (1.2, 0.8), (30.0, -12.0), ((0.8, -0.6), (0.6, 0.8))),
    "space": Grid(
        (14, 15, 16),
        (1.0, 1.1, 1.4),
        (3.0, 0.0, -5.0),
        ((0.6, 0.0, -0.8), (0.0, -1.0, 0.0), (0.8, 0.0, 0.6)),
    ),
}
DESCENT = {
    "type": "gradient-descent",
    "estimate_learning_rate": "each-iteration",
    "maximum_step": 0.5,
    "keep": "last",
}


def preset(order, factors, mesh, **changes):
    shrinks = (4, 2, 1)[-len(factors) :]
    levels = [
        {"shrink": s, "smooth": s / 2 if s > 1 else 0.0, "iterations": 3, **({"refine": f} if f else {})}
        for s, f in zip(shrinks, factors, strict=True)
    ]
    stage = {
        "transform": {"type": "bspline", "mesh": mesh, "order": order},
        "interpolator": "linear",
        "metric": "mean-squares",
        "gradient": "filtered",
        "scales": "physical-shift",
        "optimizer": DESCENT,
        "levels": levels,
        **changes,
    }
    return parse({"stages": [stage]})


@pytest.mark.parametrize(
    "grid",
    [pytest.param(grid, id=name, marks=[pytest.mark.slow] * (grid.dim == 3)) for name, grid in GRIDS.items()],
)
@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("factors", [(1, 2, 4), (0, 1, 2), (2, 0, 1)], ids=str)
def test_both_engines_refine_alike(grid, order, factors):
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    mesh = [2, 3] if grid.dim == 2 else [1, 2, 1]

    ours, theirs = both(preset(order, factors, mesh), fixed, moving)

    for one, other in zip(ours.levels, theirs.levels, strict=True):
        np.testing.assert_allclose(one.params, other.params, rtol=0, atol=1e-11)
    corners = grid.points(grid.corner_indices() * 0.9 + 0.3)
    np.testing.assert_allclose(ours.warp(corners), theirs.warp(corners), rtol=0, atol=1e-11)


def test_refining_keeps_the_motion_of_the_new_control_points():
    grid = GRIDS["oblique"]
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    family = preset(3, (1, 2, 4), [2, 3]).stages[0].transform
    ours, _ = both(preset(3, (1,), [2, 3]), fixed, moving)

    params, frame = family.adapted(ours.warp.params, ours.warp.frame, grid, 2)

    points = frame.lattice.points(frame.lattice.all_indices())
    inside = grid.inside(grid.indices(points) + 1e-6) & grid.inside(grid.indices(points) - 1e-6)
    moved = family.map(params, points, frame) - points
    kept = ours.warp(points) - points
    both_told = inside & np.any(moved != 0.0, axis=1) & np.any(kept != 0.0, axis=1)
    assert fixed_parameters(family, frame)[:2] == [7.0, 9.0]
    assert both_told.sum() > 10
    np.testing.assert_allclose(moved[both_told], kept[both_told], rtol=0, atol=1e-12)


def test_other_families_have_nothing_to_refine():
    with pytest.raises(PresetError, match=r"levels\.0\.refine: the transform 'affine' has no mesh"):
        preset(3, (2,), [2], transform="affine")


def test_levels_of_other_calls_cannot_be_coarser():
    grid = GRIDS["plane"]
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    levels = [{"iterations": 2, "refine": 4}, {"iterations": 3, "refine": 2}]

    with pytest.raises(NoTwin, match="cannot refine by"):
        finished(SimpleITKEngine(), preset(3, (1,), [2, 3], levels=levels), (fixed, moving))


def test_results_tell_the_parameters_of_every_level(tmp_path):
    grid = GRIDS["plane"]
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    ours, _ = both(preset(3, (1, 2), [2, 3]), fixed, moving)

    ours.save(tmp_path / "out", figures=False)

    with (tmp_path / "out" / "trace.csv").open(newline="") as table:
        head, *rows = csv.reader(table)
    # Five by six control points, then seven by nine.
    assert "x[6,8]" in head
    assert "x[7,8]" not in head
    assert {len(row) for row in rows} == {len(head)}
