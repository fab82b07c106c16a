"""Rigid motion in the plane and in space."""

import numpy as np
import pytest

from regframe.geometry import AffineMap, Frame, Grid
from regframe.transforms.linear import turn
from regframe.transforms.rigid import Rigid

FRAME = Frame.about_centre(Grid.of_shape((5, 7)))
SPACE = Frame.about_centre(Grid.of_shape((5, 6, 7)))


def test_turns_about_the_centre_then_shifts():
    params = np.array([np.pi / 2, 10.0, 0.0])

    moved = Rigid().map(params, FRAME.centre[None] + [[1.0, 0.0]], FRAME)

    assert moved[0] == pytest.approx(FRAME.centre + np.array([10.0, 1.0]))


def test_keeps_distances():
    points = FRAME.grid.corners()

    moved = Rigid().map(np.array([0.7, 3.0, -2.0]), points, FRAME)

    assert np.linalg.norm(moved[0] - moved[-1]) == pytest.approx(np.linalg.norm(points[0] - points[-1]))


def test_names_its_parameters():
    assert Rigid().names(FRAME) == ("angle_rad", "tx", "ty")
    assert Rigid().names(SPACE) == ("angle_x_rad", "angle_y_rad", "angle_z_rad", "tx", "ty", "tz")


@pytest.mark.parametrize(("axis", "start", "end"), [(0, 1, 2), (1, 2, 0), (2, 0, 1)])
def test_a_positive_angle_in_space_turns_each_axis_to_the_next(axis, start, end):
    params = np.zeros(6)
    params[axis] = np.pi / 2

    moved = Rigid().map(params, SPACE.centre[None] + np.eye(3)[start], SPACE)

    assert moved[0] - SPACE.centre == pytest.approx(np.eye(3)[end], abs=1e-12)


def test_the_order_says_which_rotation_comes_last():
    params = np.array([np.pi / 2, np.pi / 2, 0.0, 0.0, 0.0, 0.0])

    about_x_last = Rigid().parts(params, 3)[0] @ [1.0, 0.0, 0.0]
    about_y_last = Rigid(order="zyx").parts(params, 3)[0] @ [1.0, 0.0, 0.0]

    assert about_x_last == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert about_y_last == pytest.approx([0.0, 0.0, -1.0], abs=1e-12)


@pytest.mark.parametrize("order", ["zxy", "zyx"])
@pytest.mark.parametrize("angles", [[0.3, -1.2, 2.5], [np.pi / 2, 0.4, 0.9], [0.4, -np.pi / 2, 0.9]])
def test_finds_angles_of_any_rotation(order, angles):
    rotation = Rigid(order=order).parts(np.array([*angles, 0.0, 0.0, 0.0]), 3)[0]

    found = Rigid(order=order).from_parts(rotation, np.zeros(3))

    np.testing.assert_allclose(Rigid(order=order).parts(found, 3)[0], rotation, rtol=0, atol=1e-12)


def test_nearest_rotation_of_a_scaled_one_has_its_angle():
    affine = AffineMap(1.3 * turn(0.4), np.zeros(2))

    assert Rigid().from_affine(affine, FRAME)[0] == pytest.approx(0.4)


def test_nearest_rotation_is_the_least_squares_one():
    matrix = np.array([[1.1, -0.3], [0.5, 0.8]])

    angle = Rigid().from_parts(matrix, np.zeros(2))[0]

    tried = np.linspace(-np.pi, np.pi, 20001)
    misfit = [np.sum((turn(one) - matrix) ** 2) for one in tried]
    assert angle == pytest.approx(tried[int(np.argmin(misfit))], abs=4e-4)


def test_shift_of_the_angle_is_the_corner_radius():
    radius = np.linalg.norm(FRAME.grid.corners()[0] - FRAME.centre)

    assert Rigid().shift(np.zeros(3), FRAME) == pytest.approx([radius, 1.0, 1.0], rel=1e-6)
