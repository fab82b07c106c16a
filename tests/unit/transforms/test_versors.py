"""The families in space that are written with a versor, and plain scaling."""

import numpy as np
import pytest

from regframe.geometry import AffineMap, Frame, Grid
from regframe.transforms.affine import Affine
from regframe.transforms.rotations import versor_matrix
from regframe.transforms.scale import Scale
from regframe.transforms.scale_skew_versor import ScaleSkewVersor
from regframe.transforms.scale_versor import ScaleVersor
from regframe.transforms.versor import Versor
from regframe.transforms.versor_rigid import VersorRigid
from regframe.transforms.warp import Warp

FRAME = Frame.about_centre(Grid.of_shape((5, 6, 7)))
TURN = np.array([0.2, -0.3, 0.4])
MATRIX = np.array([[1.1, -0.3, 0.2], [0.5, 0.8, -0.1], [0.0, 0.3, 1.3]])


@pytest.mark.parametrize(
    ("family", "names"),
    [
        (Versor(), "vx vy vz"),
        (VersorRigid(), "vx vy vz tx ty tz"),
        (Scale(), "scale_x scale_y scale_z"),
        (ScaleVersor(), "vx vy vz tx ty tz scale_x scale_y scale_z"),
        (
            ScaleSkewVersor(),
            "vx vy vz tx ty tz scale_x scale_y scale_z skew_xy skew_xz skew_yx skew_yz skew_zx skew_zy",
        ),
    ],
)
def test_parameters_are_in_itk_order(family, names):
    assert " ".join(family.names(FRAME)) == names


@pytest.mark.parametrize("family", [Versor(), VersorRigid(), ScaleVersor(), ScaleSkewVersor()])
def test_knows_space_only(family):
    assert family.dimensions == (3,)


def test_scales_are_added_to_the_rotation_as_in_itk():
    matrix, _ = ScaleVersor().parts(np.array([*TURN, 0.0, 0.0, 0.0, 1.5, 1.0, 0.5]), 3)

    assert np.array_equal(matrix, versor_matrix(TURN) + np.diag([0.5, 0.0, -0.5]))


def test_skews_stand_off_the_diagonal_row_by_row():
    skews = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]

    matrix, _ = ScaleSkewVersor().parts(np.array([0.0] * 6 + [1.0] * 3 + skews), 3)

    assert matrix.tolist() == [[1.0, 0.1, 0.2], [0.3, 1.0, 0.4], [0.5, 0.6, 1.0]]


def test_every_matrix_has_scales_and_skews():
    found = ScaleSkewVersor().from_parts(MATRIX, np.zeros(3))

    np.testing.assert_allclose(ScaleSkewVersor().parts(found, 3)[0], MATRIX, rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("family", "free"), [(VersorRigid(), range(3)), (ScaleVersor(), [0, 1, 2, 6, 7, 8]), (Scale(), range(3))]
)
def test_the_nearest_member_is_the_least_squares_one(family, free):
    best = family.from_parts(MATRIX, np.zeros(3))

    def misfit(params):
        return np.sum((family.parts(params, 3)[0] - MATRIX) ** 2)

    for axis in free:
        for side in (1e-3, -1e-3):
            assert misfit(best) < misfit(best + side * np.eye(len(best))[axis])


@pytest.mark.parametrize("family", [Versor(), Scale()])
def test_families_without_a_shift_drop_it(family):
    affine = AffineMap(np.eye(3), np.array([1.0, 2.0, 3.0]))

    assert np.array_equal(family.from_affine(affine, FRAME), family.identity(FRAME))


def test_the_inverse_of_added_scales_is_plainly_affine():
    params = np.array([*TURN, 1.0, 2.0, 3.0, 1.5, 1.0, 0.7])
    warp = Warp(ScaleVersor(), params, FRAME)

    back = warp.inverse()

    assert isinstance(back.transform, Affine)
    np.testing.assert_allclose(back(warp(FRAME.grid.corners())), FRAME.grid.corners(), rtol=0, atol=1e-12)


def test_a_versor_never_outgrows_half_a_turn():
    assert np.linalg.norm(Versor().advance(TURN, np.array([0.0, 0.0, 5.0]), FRAME)) < 1.0
