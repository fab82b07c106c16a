"""Fields of displacements."""

import numpy as np
import pytest

from regframe.engine.start import begin
from regframe.geometry import Frame, Grid
from regframe.image import Image
from regframe.preset import Stage
from regframe.transforms import files
from regframe.transforms.bspline import BSpline
from regframe.transforms.displacement_field import DisplacementField
from regframe.transforms.warp import Warp

GRID = Grid((5, 6), (0.8, 1.5), (-4.0, 11.0), ((0.8, -0.6), (0.6, 0.8)))
FRAME = Frame.about_centre(GRID)
FAMILY = DisplacementField()


def naive(params, index):
    """Displacement at one index, z y x, corner by corner."""
    field, total = params.reshape(*GRID.shape, 2), np.zeros(2)
    if not all(-0.5 <= c < n - 0.5 for c, n in zip(index, GRID.shape, strict=True)):
        return total
    low = [int(np.floor(c)) for c in index]
    for corner in np.ndindex(2, 2):
        places = [b + k for b, k in zip(low, corner, strict=True)]
        shares = [c - b if k else 1 - (c - b) for c, b, k in zip(index, low, corner, strict=True)]
        kept = [min(max(p, 0), n - 1) for p, n in zip(places, GRID.shape, strict=True)]
        total += np.prod(shares) * field[tuple(kept)]
    return total


def random_warp(seed=1):
    return Warp(FAMILY, np.random.default_rng(seed).normal(size=GRID.size * 2), FRAME)


def test_is_linear_between_points_and_still_beyond():
    warp = random_warp()
    indices = np.random.default_rng(2).uniform(-1.5, 6.5, (200, 2))
    points = GRID.points(indices)

    moved = warp(points) - points

    wanted = np.array([naive(warp.params, index) for index in indices])
    assert np.any(np.all(wanted == 0.0, axis=1))
    np.testing.assert_allclose(moved, wanted, rtol=0, atol=1e-13)


def test_forces_are_scattered_as_vectors_are_gathered():
    indices = np.random.default_rng(2).uniform(-1.5, 6.5, (50, 2))
    points, forces = GRID.points(indices), np.random.default_rng(3).normal(size=(50, 2))

    got = FAMILY.parameter_gradient(np.zeros(GRID.size * 2), points, forces, FRAME)

    units = np.eye(GRID.size * 2)
    wanted = [
        sum(force @ naive(unit, at) for force, at in zip(forces, indices, strict=True)) for unit in units
    ]
    np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-12)


def test_a_level_begins_with_the_field_read_at_its_points():
    warp, coarse = random_warp(), GRID.coarsen(2)

    params, frame = FAMILY.adapted(warp.params, FRAME, coarse, None)

    points = coarse.points(coarse.all_indices())
    assert frame.lattice == coarse
    np.testing.assert_allclose(FAMILY.map(params, points, frame), warp(points), rtol=0, atol=1e-12)


def test_takes_over_any_map():
    image = Image(np.arange(30.0).reshape(5, 6), GRID, name="image")
    bent = BSpline(mesh=(2,))
    before = Warp(bent, np.random.default_rng(5).normal(size=len(bent.identity(FRAME))), FRAME)
    parts = {"interpolator": "linear", "metric": "mattes", "optimizer": "gradient-descent"}

    found = begin(Stage(start="previous", transform=FAMILY, **parts), image, image, before)

    points = GRID.points(GRID.all_indices())
    np.testing.assert_allclose(found(points), before(points), rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", ["warp.tfm", "warp.h5"])
@pytest.mark.parametrize("family", [FAMILY, BSpline(mesh=(2, 3)), BSpline(mesh=(2,), order=2)], ids=repr)
def test_survives_files_on_a_lattice_of_its_own(tmp_path, family, name):
    lattice = Grid((7, 8), (1.1, 0.9), (-5.0, 10.0), GRID.direction)
    if isinstance(family, BSpline):
        cells = family.mesh * (2 if len(family.mesh) == 1 else 1)
        shape = tuple(n + family.order for n in reversed(cells))
        lattice = Grid(shape, lattice.spacing, lattice.origin, lattice.direction)
    frame = Frame(GRID, GRID.centre, lattice)
    warp = Warp(family, np.random.default_rng(6).normal(size=len(family.identity(frame))), frame)

    files.write(warp, tmp_path / name)
    read = files.read(tmp_path / name, GRID)

    points = GRID.points(GRID.all_indices())
    assert read.transform == family
    assert np.array_equal(read.params, warp.params)
    np.testing.assert_allclose(read(points), warp(points), rtol=0, atol=1e-12)
