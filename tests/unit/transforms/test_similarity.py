"""Similarity in the plane and in space."""

import numpy as np
import pytest

from regframe.geometry import AffineMap, Frame, Grid
from regframe.transforms.linear import turn
from regframe.transforms.similarity import Similarity

FRAME = Frame.about_centre(Grid.of_shape((5, 7)))
SPACE = Frame.about_centre(Grid.of_shape((5, 6, 7)))


def test_scales_turns_and_shifts():
    params = np.array([2.0, np.pi / 2, 10.0, -1.0])

    moved = Similarity().map(params, FRAME.centre[None] + [[1.0, 0.0]], FRAME)

    assert moved[0] == pytest.approx(FRAME.centre + np.array([10.0, 1.0]))


def test_identity_has_scale_one():
    assert Similarity().identity(FRAME).tolist() == [1.0, 0.0, 0.0, 0.0]


def test_parameters_are_in_itk_order():
    assert Similarity().names(FRAME) == ("scale", "angle_rad", "tx", "ty")


def test_multiplies_distances():
    points = FRAME.grid.corners()

    moved = Similarity().map(np.array([0.8, 0.7, 3.0, -2.0]), points, FRAME)

    assert np.linalg.norm(moved[0] - moved[-1]) == pytest.approx(0.8 * np.linalg.norm(points[0] - points[-1]))


def test_finds_the_parameters_of_a_similarity():
    params = np.array([1.2, -2.5, 3.0, 4.0])

    found = Similarity().from_affine(Similarity().as_affine(params, FRAME), FRAME)

    assert found == pytest.approx(params, abs=1e-12)


def test_nearest_similarity_is_the_least_squares_one():
    matrix = np.array([[1.1, -0.3], [0.5, 0.8]])
    similarity = Similarity()

    best = similarity.from_parts(matrix, np.zeros(2))

    def misfit(params):
        return np.sum((params[0] * turn(params[1]) - matrix) ** 2)

    for step in ([1e-3, 0, 0, 0], [-1e-3, 0, 0, 0], [0, 1e-3, 0, 0], [0, -1e-3, 0, 0]):
        assert misfit(best) < misfit(best + step)


def test_nearest_similarity_agrees_at_the_centre():
    affine = AffineMap(np.array([[1.1, -0.3], [0.5, 0.8]]), np.array([7.0, -2.0]))

    found = Similarity().as_affine(Similarity().from_affine(affine, FRAME), FRAME)

    assert found(FRAME.centre[None]) == pytest.approx(affine(FRAME.centre[None]))


def test_parameters_in_space_are_in_itk_order():
    assert Similarity().names(SPACE) == ("vx", "vy", "vz", "tx", "ty", "tz", "scale")


def test_finds_the_parameters_of_a_similarity_in_space():
    params = np.array([0.3, -0.5, 0.1, 3.0, 4.0, 5.0, 1.2])

    found = Similarity().from_affine(Similarity().as_affine(params, SPACE), SPACE)

    assert found == pytest.approx(params, abs=1e-12)


def test_nearest_similarity_in_space_is_the_least_squares_one():
    matrix = np.array([[1.1, -0.3, 0.2], [0.5, 0.8, -0.1], [0.0, 0.3, 1.3]])
    best = Similarity().from_parts(matrix, np.zeros(3))

    def misfit(params):
        return np.sum((Similarity().parts(params, 3)[0] - matrix) ** 2)

    for axis in (0, 1, 2, 6):
        for side in (1e-3, -1e-3):
            assert misfit(best) < misfit(best + side * np.eye(7)[axis])
