"""Translation."""

import numpy as np
import pytest

from regframe.geometry import AffineMap, Frame, Grid
from regframe.transforms.translation import Translation

FRAMES = [Frame.about_centre(Grid.of_shape(shape)) for shape in ((5, 7), (3, 5, 7))]


@pytest.mark.parametrize("frame", FRAMES)
def test_adds_its_parameters(frame):
    params, points = np.arange(1.0, frame.dim + 1), frame.grid.corners()

    assert np.array_equal(Translation().map(params, points, frame), points + params)


@pytest.mark.parametrize("frame", FRAMES)
def test_names_follow_the_axes(frame):
    assert Translation().names(frame) == ("tx", "ty", "tz")[: frame.dim]


@pytest.mark.parametrize("frame", FRAMES)
def test_each_parameter_moves_one_millimetre_per_unit(frame):
    assert Translation().shift(np.zeros(frame.dim), frame) == pytest.approx(np.ones(frame.dim))


def test_nearest_translation_agrees_at_the_centre():
    frame = FRAMES[0]
    affine = AffineMap(np.array([[1.1, 0.2], [0.0, 0.9]]), np.array([3.0, -1.0]))

    params = Translation().from_affine(affine, frame)

    assert Translation().map(params, frame.centre[None], frame) == pytest.approx(affine(frame.centre[None]))


def test_found_parameters_are_not_shared():
    translation = np.array([1.0, 2.0])

    params = Translation().from_parts(np.eye(2), translation)
    params += 1.0

    assert translation.tolist() == [1.0, 2.0]
