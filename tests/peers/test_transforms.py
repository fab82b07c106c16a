"""Transforms against SimpleITK's: the same parameters and centre put points at the same places."""

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.geometry import Frame, Grid
from regframe.transforms.affine import Affine
from regframe.transforms.rigid import Rigid
from regframe.transforms.scale import Scale
from regframe.transforms.scale_skew_versor import ScaleSkewVersor
from regframe.transforms.scale_versor import ScaleVersor
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.versor import Versor
from regframe.transforms.versor_rigid import VersorRigid
from regframe.transforms.warp import Warp


def zyx():
    made = sitk.Euler3DTransform()
    made.SetComputeZYX(True)
    return made


TWINS = {
    "translation-2d": (Translation(), 2, lambda: sitk.TranslationTransform(2)),
    "translation-3d": (Translation(), 3, lambda: sitk.TranslationTransform(3)),
    "rigid": (Rigid(), 2, sitk.Euler2DTransform),
    "rigid-3d": (Rigid(), 3, sitk.Euler3DTransform),
    "rigid-3d-zyx": (Rigid(order="zyx"), 3, zyx),
    "similarity": (Similarity(), 2, sitk.Similarity2DTransform),
    "similarity-3d": (Similarity(), 3, sitk.Similarity3DTransform),
    "scale-2d": (Scale(), 2, lambda: sitk.ScaleTransform(2)),
    "scale-3d": (Scale(), 3, lambda: sitk.ScaleTransform(3)),
    "versor": (Versor(), 3, sitk.VersorTransform),
    "versor-rigid": (VersorRigid(), 3, sitk.VersorRigid3DTransform),
    "scale-versor": (ScaleVersor(), 3, sitk.ScaleVersor3DTransform),
    "scale-skew-versor": (ScaleSkewVersor(), 3, sitk.ScaleSkewVersor3DTransform),
    "affine-2d": (Affine(), 2, lambda: sitk.AffineTransform(2)),
    "affine-3d": (Affine(), 3, lambda: sitk.AffineTransform(3)),
}
# Here the last parameters are not shifts.
SHIFTLESS = {"scale-2d", "scale-3d", "versor"}
SHIFTED_EARLY = {"similarity-3d", "scale-versor", "scale-skew-versor"}
each = pytest.mark.parametrize("twin", TWINS)
SEEDS = range(5)
# Points and offsets reach 1e3, where the last bit is worth 1e-13; the bound is relative to that.
ROUNDING = 1e-13


def pair(twin, seed):
    """Our warp and SimpleITK's transform with the same drawn parameters and centre, and some points."""
    family, dim, make = TWINS[twin]
    rng = np.random.default_rng((seed, 20))
    frame = Frame(
        Grid.of_shape((48, 64)[:dim] if dim == 2 else (20, 48, 64)), rng.uniform(-200.0, 200.0, dim)
    )
    params = family.identity(frame) + rng.uniform(-0.5, 0.5, len(family.identity(frame)))
    if twin in SHIFTED_EARLY:
        params[3:6] *= 100.0
    elif twin not in SHIFTLESS:
        params[-dim:] *= 100.0
    theirs = make()
    if not twin.startswith("translation"):
        theirs.SetCenter(frame.centre.tolist())
    theirs.SetParameters(params.tolist())
    return Warp(family, params, frame), theirs, rng.uniform(-300.0, 300.0, (40, dim))


def mapped(theirs, points):
    return np.array([theirs.TransformPoint(point.tolist()) for point in points])


@each
@pytest.mark.parametrize("seed", SEEDS)
def test_points_go_to_the_same_places(twin, seed):
    ours, theirs, points = pair(twin, seed)

    wanted = mapped(theirs, points)

    np.testing.assert_allclose(ours(points), wanted, rtol=0, atol=ROUNDING * 1e3)


@pytest.mark.parametrize(
    "twin", [name for name in TWINS if not name.startswith("scale-") or "versor" in name]
)
@pytest.mark.parametrize("seed", SEEDS)
def test_places_are_equal_to_the_last_bit(twin, seed):
    """The sums run in ITK's order, because the last bit decides on which side of a border a sample is.

    Only its ScaleTransform goes to the centre and back instead of adding an offset.
    """
    ours, theirs, points = pair(twin, seed)

    assert np.array_equal(ours(points), mapped(theirs, points))


@pytest.mark.parametrize("twin", [name for name in TWINS if not name.startswith("translation")])
def test_the_matrix_is_the_same(twin):
    ours, theirs, _ = pair(twin, 1)

    matrix = np.array(theirs.GetMatrix()).reshape(ours.frame.dim, -1)

    np.testing.assert_allclose(ours.as_affine().matrix, matrix, rtol=0, atol=1e-15)


@each
def test_the_identity_has_the_same_parameters(twin):
    family, dim, make = TWINS[twin]
    frame = Frame.about_centre(Grid.of_shape((9,) * dim))

    assert family.identity(frame).tolist() == list(make().GetParameters())


@each
def test_parameter_gradient_is_that_of_their_map(twin):
    ours, theirs, points = pair(twin, 2)
    forces = np.random.default_rng(21).standard_normal(points.shape)

    got = ours.transform.parameter_gradient(ours.params, points, forces, ours.frame)

    wanted, step = [], 1e-5
    for i in range(len(got)):
        ends = []
        for side in (1, -1):
            moved = ours.params.copy()
            moved[i] += side * step
            theirs.SetParameters(moved.tolist())
            ends.append(mapped(theirs, points))
        wanted.append(np.sum(forces * (ends[0] - ends[1])) / (2 * step))
    # Central differences of cosines err by step^2 / 6; rounding of points by 1e-13 / step.
    np.testing.assert_allclose(got, wanted, rtol=1e-6, atol=1e-5)


# ITK refuses to invert transforms with added scales.
@pytest.mark.parametrize("twin", [name for name in TWINS if not name.startswith(("scale-v", "scale-s"))])
def test_their_inverse_is_ours(twin):
    ours, theirs, points = pair(twin, 3)

    wanted = mapped(theirs.GetInverse(), points)

    np.testing.assert_allclose(ours.inverse()(points), wanted, rtol=0, atol=1e-9)


def test_their_composite_applies_the_last_one_first():
    first, their_first, points = pair("similarity", 4)
    second, their_second, _ = pair("affine-2d", 4)

    wanted = mapped(sitk.CompositeTransform([their_second, their_first]), points)

    np.testing.assert_allclose((second @ first)(points), wanted, rtol=0, atol=1e-9)


@pytest.mark.parametrize("dim", [2, 3])
def test_grids_speak_of_the_same_points(dim):
    rng = np.random.default_rng(dim)
    turn = np.linalg.qr(rng.standard_normal((dim, dim)))[0]
    shape = (6, 9) if dim == 2 else (4, 6, 9)
    rows = tuple(tuple(map(float, row)) for row in turn)
    grid = Grid(shape, tuple(rng.uniform(0.3, 3, dim)), tuple(rng.uniform(-50, 50, dim)), rows)
    theirs = sitk.Image(shape[::-1], sitk.sitkUInt8)
    theirs.SetSpacing(grid.spacing)
    theirs.SetOrigin(grid.origin)
    theirs.SetDirection([value for row in rows for value in row])
    indices = rng.uniform(-1, 1, (30, dim)) + rng.uniform(0, 1, (30, dim)) * np.array(shape)

    points = np.array([theirs.TransformContinuousIndexToPhysicalPoint(one[::-1].tolist()) for one in indices])
    back = np.array([theirs.TransformPhysicalPointToContinuousIndex(one.tolist()) for one in points])[:, ::-1]

    np.testing.assert_allclose(grid.points(indices), points, rtol=0, atol=ROUNDING * 1e2)
    assert np.array_equal(grid.indices(points), back)


@pytest.mark.parametrize("dim", [2, 3])
def test_whole_indices_are_points_to_the_last_bit(dim):
    rng = np.random.default_rng(dim + 7)
    turn = np.linalg.qr(rng.standard_normal((dim, dim)))[0]
    shape = (6, 9) if dim == 2 else (4, 6, 9)
    rows = tuple(tuple(map(float, row)) for row in turn)
    grid = Grid(shape, tuple(rng.uniform(0.3, 3, dim)), tuple(rng.uniform(-50, 50, dim)), rows)
    theirs = sitk.Image(shape[::-1], sitk.sitkUInt8)
    theirs.SetSpacing(grid.spacing)
    theirs.SetOrigin(grid.origin)
    theirs.SetDirection([value for row in rows for value in row])

    indices = grid.all_indices()

    wanted = [theirs.TransformIndexToPhysicalPoint([int(i) for i in one[::-1]]) for one in indices]
    assert np.array_equal(grid.points(indices), np.array(wanted))
