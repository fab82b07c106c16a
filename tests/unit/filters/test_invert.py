import numpy as np
import pytest

from regframe.filters.invert import Invert
from regframe.image import Image


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32, np.float64])
def test_exchanges_dark_and_bright_within_the_range(dtype):
    image = Image.of_array(np.array([[3, 4], [7, 13]], dtype))

    inverted = Invert()(image)

    assert inverted.values.dtype == image.values.dtype
    np.testing.assert_array_equal(inverted.values, [[13, 12], [9, 3]])


def test_twice_is_nothing():
    image = Image.of_array(np.random.default_rng(0).integers(0, 1 << 14, (5, 6, 7)).astype(np.uint16))

    np.testing.assert_array_equal(Invert()(Invert()(image)).values, image.values)


def test_takes_the_range_under_the_mask():
    mask = np.array([[True, True, False]])
    image = Image.of_array(np.array([[1.0, 5.0, 100.0]])).with_mask(mask)

    np.testing.assert_array_equal(Invert()(image).values, [[5, 1, -94]])
