"""What all matrix-and-offset transforms share."""

import numpy as np
import pytest

from regframe.geometry import AffineMap
from regframe.transforms.linear import about, translation_about, turn


def test_about_leaves_the_centre_where_the_translation_puts_it():
    centre = np.array([3.0, -2.0])

    affine = about(1.7 * turn(0.4), np.array([5.0, 1.0]), centre)

    assert affine(centre[None])[0] == pytest.approx(centre + np.array([5.0, 1.0]))


def test_about_sums_the_offset_in_itk_order():
    """translation + centre, then minus each column in turn: the last bit decides pixel borders."""
    matrix, centre, translation = 0.1 * turn(0.7), np.array([0.1, 1e6 + 0.3]), np.array([0.3, 1.0 / 3.0])

    offset = about(matrix, translation, centre).offset

    wanted = []
    for row in range(2):
        total = translation[row] + centre[row]
        for column in range(2):
            total -= matrix[row, column] * centre[column]
        wanted.append(total)
    assert offset.tolist() == wanted


def test_translation_about_undoes_about():
    affine = AffineMap(np.array([[1.0, 0.2], [-0.1, 0.9]]), np.array([4.0, 5.0]))
    centre = np.array([10.0, 20.0])

    again = about(affine.matrix, translation_about(affine, centre), centre)

    assert again.offset == pytest.approx(affine.offset, abs=1e-13)


def test_a_positive_angle_turns_x_towards_y():
    assert turn(np.pi / 2) @ [1.0, 0.0] == pytest.approx([0.0, 1.0])
