"""Affine maps and their factors."""

import numpy as np
import pytest

from regframe.errors import PresetError
from regframe.geometry import Frame, Grid
from regframe.transforms.affine import FACTORS, Affine, factors, from_factors
from regframe.transforms.linear import turn

PLANE, SPACE = (Frame.about_centre(Grid.of_shape(shape)) for shape in ((5, 7), (3, 5, 7)))


def test_parameters_are_the_matrix_by_rows_then_the_shift():
    params = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])

    affine = Affine().as_affine(params, Frame(PLANE.grid, np.zeros(2)))

    assert affine.matrix.tolist() == [[1, 2], [3, 4]]
    assert affine.offset.tolist() == [5, 6]


@pytest.mark.parametrize(("frame", "count"), [(PLANE, 6), (SPACE, 12)])
def test_has_a_parameter_for_each_entry(frame, count):
    assert len(Affine().identity(frame)) == count
    assert len(Affine().names(frame)) == count


def test_names_tell_row_and_column():
    assert Affine().names(PLANE) == ("mxx", "mxy", "myx", "myy", "tx", "ty")


def test_multiplies_about_the_centre():
    params = np.array([2.0, 0.0, 0.0, 2.0, 0.0, 0.0])

    assert Affine().map(params, PLANE.centre[None], PLANE) == pytest.approx(PLANE.centre[None])


def test_factors_of_the_identity_are_neutral():
    found = factors(np.eye(2), np.zeros(2))

    assert found == dict(zip(FACTORS, (0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0), strict=True))


def test_factors_come_back():
    given = dict(zip(FACTORS, (3.0, -4.0, 0.3, 1.2, 0.7, 0.1, 0.0), strict=True))

    params = from_factors(given)

    assert factors(params[:4].reshape(2, 2), params[4:]) == pytest.approx(given)


def test_factors_with_two_shears_give_the_same_map_back():
    params = from_factors({"rotation_rad": 0.2, "shear_x": 0.1, "shear_y": -0.3, "scale_x": 1.4})

    again = from_factors(factors(params[:4].reshape(2, 2), params[4:]))

    assert again == pytest.approx(params, abs=1e-13)


def test_factors_of_a_mirror_have_a_negative_scale():
    params = from_factors(factors(np.diag([1.0, -1.0]), np.zeros(2)))

    assert params == pytest.approx([1.0, 0.0, 0.0, -1.0, 0.0, 0.0])


def test_factors_of_a_flat_map_are_numbers():
    found = factors(np.array([[1.0, 0.0], [0.0, 0.0]]), np.zeros(2))

    assert all(np.isfinite(value) for value in found.values())


def test_rotation_comes_last():
    """The matrix is R @ shear @ scale, so a scaled square is turned as a whole."""
    params = from_factors({"rotation_rad": 0.5, "scale_x": 2.0})

    assert params[:4].reshape(2, 2) == pytest.approx(turn(0.5) @ np.diag([2.0, 1.0]))


def test_an_unknown_factor_is_named():
    with pytest.raises(PresetError, match=r"unknown affine factors \['zoom'\].*scale_x"):
        from_factors({"zoom": 2.0})
