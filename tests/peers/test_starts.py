"""Starts by moments and principal axes against SimpleITK's initialisers."""

from itertools import product

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.engine.itk_axes import eigenvectors
from regframe.engine.moments import principal_axes, turn_between
from regframe.engine.start import begin
from regframe.errors import GeometryError
from regframe.geometry import Grid
from regframe.image import Image
from regframe.preset import Stage
from regframe.transforms.rotations import versor_matrix
from support import sitk as peer

TURNED = ((0.6, 0.0, -0.8), (0.0, -1.0, 0.0), (0.8, 0.0, 0.6))
UPRIGHT = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
SPACE = Grid((18, 20, 24), (1.0, 1.2, 1.5), (4.0, -7.0, 2.0), UPRIGHT)
OBLIQUE = Grid((18, 20, 24), (1.0, 1.2, 1.5), (4.0, -7.0, 2.0), TURNED)


def blob(grid, versor, shift):
    """An ellipsoid with a dent, turned and shifted about the grid's centre."""
    turn = versor_matrix(np.array(versor))
    points = grid.points(grid.all_indices()) - grid.centre - np.array(shift)
    local = points @ turn
    radii = np.array([1.6, 2.4, 3.6])
    values = np.exp(-0.5 * ((local / radii) ** 2).sum(axis=1))
    values += 0.3 * np.exp(-0.5 * (((local - radii * 0.7) / 1.5) ** 2).sum(axis=1))
    return Image(values.reshape(grid.shape), grid, name="blob")


def stage(start):
    parts = {"interpolator": "linear", "metric": "mattes", "optimizer": "one-plus-one"}
    return Stage(start=start, transform="versor-rigid", **parts)


def theirs_of(fixed, moving, turned):
    made = sitk.CenteredVersorTransformInitializer(
        peer.image(fixed), peer.image(moving), sitk.VersorRigid3DTransform(), turned
    )
    return sitk.VersorRigid3DTransform(made)


@pytest.mark.parametrize("grid", [SPACE, OBLIQUE], ids=["upright", "oblique"])
def test_moments_are_the_initialiser_without_rotation(grid):
    fixed, moving = (
        blob(grid, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        blob(SPACE, (0.1, 0.2, -0.1), (1.0, 2.0, -1.0)),
    )

    ours, theirs = begin(stage("moments"), fixed, moving, None), theirs_of(fixed, moving, False)

    np.testing.assert_allclose(ours.frame.centre, theirs.GetCenter(), rtol=0, atol=1e-12)
    np.testing.assert_allclose(ours.params, theirs.GetParameters(), rtol=0, atol=1e-12)


@pytest.mark.parametrize("grid", [SPACE, OBLIQUE], ids=["upright", "oblique"])
@pytest.mark.parametrize("versor", [(0.1, 0.05, -0.08), (-0.15, 0.2, 0.1), (0.3, -0.2, 0.25)])
def test_principal_axes_are_theirs_but_not_the_turn(grid, versor):
    """ITK multiplies its matrices of axes, one a row, the wrong way round: it turns against the right way."""
    fixed, moving = blob(grid, (0.02, -0.01, 0.03), (0.5, 0.0, -0.5)), blob(SPACE, versor, (1.0, 2.0, -1.0))

    ours, theirs = begin(stage("principal-axes"), fixed, moving, None), theirs_of(fixed, moving, True)

    np.testing.assert_allclose(ours.frame.centre, theirs.GetCenter(), rtol=0, atol=1e-12)
    np.testing.assert_allclose(ours.params[3:], theirs.GetTranslation(), rtol=0, atol=1e-12)
    first, second = principal_axes(fixed), principal_axes(moving)
    told = np.array(theirs.GetMatrix()).reshape(3, 3)
    # Which end of an axis is its front is up to the solver of either side.
    ends = [np.array(one) for one in product((1.0, -1.0), repeat=3)]
    swapped = [(second * one[:, None]) @ (first * other[:, None]).T for one in ends for other in ends]
    assert min(np.abs(turn - told).max() for turn in swapped) < 1e-11
    assert min(np.abs((second.T * one) @ first - told).max() for one in ends) > 0.05


@pytest.mark.parametrize("grid", [SPACE, OBLIQUE], ids=["upright", "oblique"])
@pytest.mark.parametrize("seed", range(12))
def test_itks_own_turn_is_found(grid, seed):
    """The ends of axes included, which hang on each step of its solver."""
    first, second = np.random.default_rng(seed).uniform(-0.55, 0.55, (2, 3))
    fixed, moving = blob(grid, first, (0.5, 0.0, -0.5)), blob(SPACE, second, (1.0, 2.0, -1.0))

    ours, theirs = begin(stage("itk-principal-axes"), fixed, moving, None), theirs_of(fixed, moving, True)

    told = [theirs.TransformPoint(point) for point in grid.corners().tolist()]
    np.testing.assert_allclose(ours(grid.corners()), told, rtol=0, atol=1e-9)


def test_itks_turn_of_images_along_the_axes():
    fixed, moving = (
        blob(SPACE, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        blob(SPACE, (0.1, 0.2, 0.0), (0.0, 0.0, 0.0)),
    )
    ours, theirs = begin(stage("itk-principal-axes"), fixed, moving, None), theirs_of(fixed, moving, True)

    told = [theirs.TransformPoint(point) for point in SPACE.corners().tolist()]
    np.testing.assert_allclose(ours(SPACE.corners()), told, rtol=0, atol=1e-9)


def test_itks_turn_is_refused_in_a_plane():
    grid = Grid.of_shape((20, 24))
    image = Image(np.random.default_rng(1).random(grid.shape), grid, name="plane")
    parts = {"interpolator": "linear", "metric": "mattes", "optimizer": "one-plus-one"}

    with pytest.raises(GeometryError, match='Write "principal-axes"'):
        begin(Stage(start="itk-principal-axes", transform="rigid", **parts), image, image, None)


@pytest.mark.parametrize(
    "symmetric",
    [np.eye(3), np.diag([3.0, 1.0, 2.0]), [[2.0, 0, 0], [0, 3, 1], [0, 1, 3]], np.ones((3, 3))],
    ids=["equal", "sorted otherwise", "one coupled", "of rank 1"],
)
def test_eigenvectors_of_special_matrices(symmetric):
    symmetric = np.array(symmetric, dtype=np.float64)

    vectors = eigenvectors(symmetric)

    values = np.diag(vectors.T @ symmetric @ vectors)
    np.testing.assert_allclose(vectors @ np.diag(values) @ vectors.T, symmetric, rtol=0, atol=1e-14)
    np.testing.assert_allclose(values, np.linalg.eigvalsh(symmetric), rtol=0, atol=1e-14)


@pytest.mark.parametrize("versor", [(0.1, 0.05, -0.08), (0.3, -0.2, 0.25)])
def test_the_smallest_turn_is_found(versor):
    """A head is rarely upside down: of all turns that fit the axes the smallest one is meant."""
    fixed, moving = blob(SPACE, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), blob(SPACE, versor, (1.0, 0.0, 0.0))

    turn = turn_between(fixed, moving)

    # The blobs are sampled coarsely.
    np.testing.assert_allclose(turn, versor_matrix(np.array(versor)), rtol=0, atol=0.01)


def test_principal_axes_of_a_plane():
    grid = Grid.of_shape((40, 50))
    y, x = np.indices(grid.shape)
    across, along = x - 25.0, y - 20.0
    cos, sin = np.cos(0.4), np.sin(0.4)
    fixed = Image(np.exp(-(across**2 / 98.0 + along**2 / 18.0)), grid, name="fixed")
    turned = (cos * across + sin * along) ** 2 / 98.0 + (cos * along - sin * across) ** 2 / 18.0
    moving = Image(np.exp(-turned), grid, name="moving")
    parts = {"interpolator": "linear", "metric": "mattes", "optimizer": "one-plus-one"}

    found = begin(Stage(start="principal-axes", transform="rigid", **parts), fixed, moving, None)

    np.testing.assert_allclose(found.params[0], 0.4, atol=0.01)


@pytest.mark.parametrize("unit", ["physical", "voxels"])
def test_smoothing_units(unit):
    from regframe.preset import parse
    from support.runs import both

    grid = Grid((40, 48), (1.3, 0.7), (30.0, -12.0), ((0.8, -0.6), (0.6, 0.8)))
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    chosen = parse(
        {
            "stages": [
                {
                    "transform": "rigid",
                    "interpolator": "linear",
                    "metric": "mattes",
                    "optimizer": {"type": "one-plus-one", "radius": 0.7},
                    "scales": [400.0, 1.0, 1.0],
                    "smooth_unit": unit,
                    "levels": [
                        {"shrink": 2, "smooth": 1.7, "iterations": 10},
                        {"smooth": 0.6, "iterations": 10},
                    ],
                }
            ]
        }
    )

    ours, theirs = both(chosen, fixed, moving)

    np.testing.assert_allclose([p.value for p in ours.trace], [p.value for p in theirs.trace], rtol=1e-11)
    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)
