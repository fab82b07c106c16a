"""Rotations in space."""

import numpy as np
import pytest

from regframe.transforms.rotations import (
    clipped,
    nearest_rotation,
    turned,
    versor_matrix,
    versor_of,
    versor_slopes,
)

AXIS = np.array([0.6, 0.0, 0.8])


def rotation(angle_rad, axis=AXIS):
    """Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle_rad) * cross + (1.0 - np.cos(angle_rad)) * cross @ cross


def versor(angle_rad, axis=AXIS):
    return np.sin(angle_rad / 2) * axis


@pytest.mark.parametrize("angle", [0.0, 0.3, -2.0, 3.1])
def test_a_versor_is_half_the_angle_along_the_axis(angle):
    np.testing.assert_allclose(versor_matrix(versor(angle)), rotation(angle), rtol=0, atol=1e-13)


@pytest.mark.parametrize("length", [1.0, 1.5, 40.0])
def test_a_versor_that_is_too_long_is_nearly_half_a_turn(length):
    matrix = versor_matrix(length * AXIS)

    np.testing.assert_allclose(matrix, rotation(np.pi), rtol=0, atol=1e-4)
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), rtol=0, atol=1e-12)
    assert np.array_equal(versor_matrix(clipped(length * AXIS)), matrix)


def test_a_versor_short_enough_is_not_clipped():
    assert np.array_equal(clipped(0.999 * AXIS), 0.999 * AXIS)


def test_slopes_are_those_of_the_matrix():
    at, step = np.array([0.3, -0.5, 0.2]), 1e-6

    wanted = [
        (versor_matrix(at + step * unit) - versor_matrix(at - step * unit)) / (2 * step) for unit in np.eye(3)
    ]

    np.testing.assert_allclose(versor_slopes(at), wanted, rtol=0, atol=1e-9)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, -2.0, 3.1, np.pi])
@pytest.mark.parametrize("axis", [*np.eye(3), AXIS])
def test_finds_the_versor_of_a_rotation(angle, axis):
    found = versor_of(rotation(angle, axis))

    np.testing.assert_allclose(versor_matrix(found), rotation(angle, axis), rtol=0, atol=1e-4)
    np.testing.assert_allclose(np.abs(found), np.abs(versor(angle, axis)), rtol=0, atol=1e-12)


def test_the_nearest_rotation_of_a_mirror_image_is_no_mirror():
    matrix, factor = nearest_rotation(np.diag([1.0, 1.0, -1.0]))

    assert np.linalg.det(matrix) == pytest.approx(1.0)
    assert factor == pytest.approx(1 / 3)


def test_a_step_composes_rotations_and_adds_the_rest():
    params, step = (
        np.array([*versor(0.5), 1.0, 2.0]),
        np.array([*(0.4 * np.array([0.0, 1.0, 0.0])), 3.0, 4.0]),
    )

    moved = turned(params, step)

    wanted = rotation(0.5) @ rotation(0.4, np.array([0.0, 1.0, 0.0]))
    np.testing.assert_allclose(versor_matrix(moved[:3]), wanted, rtol=0, atol=1e-13)
    assert moved[3:].tolist() == [4.0, 6.0]


def test_steps_go_on_beyond_half_a_turn():
    moved = turned(versor(3.0), 0.5 * AXIS)

    np.testing.assert_allclose(versor_matrix(moved), rotation(3.5), rtol=0, atol=1e-12)


def test_no_step_clips():
    assert np.array_equal(turned(3.0 * AXIS, np.zeros(3)), clipped(3.0 * AXIS))
    assert np.array_equal(turned(0.3 * AXIS, np.zeros(3)), 0.3 * AXIS)
