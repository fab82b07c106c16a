"""Averages over blocks: where they lie, and what they hold."""

import numpy as np
import pytest

from regframe.engine.averaging import averaged, fitting, reduction
from regframe.geometry import Grid
from regframe.image import Image


def ramp(shape):
    grid = Grid.of_shape(shape)
    points = grid.points(grid.all_indices())
    return Image(np.asarray(2.0 * points[:, 0] - 3.0 * points[:, 1]).reshape(shape), grid)


@pytest.mark.parametrize("factor", [2, 3, 7])
@pytest.mark.parametrize("shape", [(40, 61), (23, 24)])
def test_a_ramp_keeps_its_values_at_its_points(shape, factor):
    coarse = averaged(ramp(shape), factor)

    points = coarse.grid.points(coarse.grid.all_indices())
    np.testing.assert_allclose(coarse.values.ravel(), 2.0 * points[:, 0] - 3.0 * points[:, 1], atol=1e-9)


def test_blocks_lie_about_the_middle():
    image = ramp((41, 62))

    coarse = averaged(image, 4)

    # Half a pixel of a border that cannot be shared evenly.
    assert np.abs(coarse.grid.centre - image.grid.centre).max() <= 0.5


def test_pixels_that_do_not_count_have_no_say():
    values, mask = np.ones((8, 8)), np.ones((8, 8), bool)
    values[0, 0], mask[0, 0] = 1e6, False
    values[4:6, 4:6], mask[4:6, 4:6] = 1e6, False

    coarse = averaged(Image.of_array(values).with_mask(mask), 2)

    assert coarse.mask is not None
    assert coarse.values[0, 0] == 1.0
    assert not coarse.mask[2, 2]
    assert coarse.mask.sum() == 15


def test_the_moving_image_is_averaged_to_the_same_spacing():
    coarse = Grid.of_shape((30, 40)).coarsen(4)

    assert reduction(coarse, Grid.of_shape((50, 50)), 1.0) == 4
    assert reduction(coarse, Grid.of_shape((50, 50)), 0.5) == 2
    assert reduction(coarse, Grid.of_shape((50, 50)), 0.1) == 1


def test_fits():
    shapes = (320, 200), (479, 200), (480, 200), (5, 960), (9, 100)

    assert [fitting(shape, 320) for shape in shapes] == [1, 1, 2, 3, 1]
