"""A level's samples in the fixed image, found a run of points at a time."""

import numpy as np
import pytest

from regframe.engine import scene
from regframe.geometry import Grid
from regframe.image import Image
from regframe.preset import Level, Stage

STAGE = Stage(transform="affine", interpolator="linear", metric="mattes", optimizer="one-plus-one")
OBLIQUE = ((0.6, -0.8, 0.0), (0.8, 0.6, 0.0), (0.0, 0.0, 1.0))
SKEWED = Grid((5, 7, 6), (1.1, 0.7, 2.3), (-3.1, 4.7, 0.3), OBLIQUE)


@pytest.mark.parametrize("grid", [Grid.of_shape((9, 11)), SKEWED], ids=["camera", "oblique"])
@pytest.mark.parametrize("shrink", [1, 2])
def test_length_of_a_run_changes_no_bit(grid, shrink, monkeypatch):
    image = Image(np.random.default_rng(1).normal(size=grid.shape), grid)
    level = Level(shrink=shrink)
    whole, _ = scene.prepare(STAGE, level, image, image, 1)
    monkeypatch.setattr(scene, "RUN", 4)

    short, _ = scene.prepare(STAGE, level, image, image, 1)

    np.testing.assert_array_equal(short.fixed, whole.fixed)
    np.testing.assert_array_equal(short.weight, whole.weight)


def test_runs_are_the_grid_in_scan_order(monkeypatch):
    monkeypatch.setattr(scene, "RUN", 4)

    runs = list(scene._runs(SKEWED))

    assert [len(run) for run in runs] == [4] * 52 + [2]
    np.testing.assert_array_equal(np.concatenate(runs), SKEWED.all_indices())


def test_oblique_places_are_those_of_the_long_way(monkeypatch):
    monkeypatch.setattr(scene, "RUN", 4)
    grid = SKEWED.coarsen(2)

    index_map, places = scene._exact_places(grid, scene.Samples(grid.shape), SKEWED)

    assert index_map is None
    np.testing.assert_array_equal(places.indices, SKEWED.indices(grid.points(grid.all_indices())))
