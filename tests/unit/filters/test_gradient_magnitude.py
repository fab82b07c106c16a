import numpy as np
import pytest

from regframe.errors import ImageError
from regframe.filters.gradient_magnitude import GradientMagnitude
from regframe.geometry import Grid
from regframe.image import Image

UPRIGHT = ((1.0, 0.0), (0.0, 1.0))
TURNED = ((0.8, -0.6), (0.6, 0.8))
SWAPPED = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0))


@pytest.mark.parametrize(
    "grid",
    [
        Grid((9, 11), (0.5, 2.0), (3.0, 4.0), UPRIGHT),
        Grid((9, 11), (0.5, 2.0), (3.0, 4.0), TURNED),
        Grid((5, 6, 7), (1.0, 2.0, 3.0), (0.0, 0.0, 0.0), SWAPPED),
    ],
    ids=["upright", "turned", "volume"],
)
def test_is_the_physical_slope_of_a_ramp(grid):
    slope = np.array([3.0, -4.0, 12.0][: grid.dim])
    ramp = (grid.points(grid.all_indices()) @ slope).reshape(grid.shape)

    found = GradientMagnitude()(Image(ramp, grid))

    np.testing.assert_allclose(found.values, np.linalg.norm(slope), rtol=1e-12)


def test_does_not_care_which_side_is_brighter():
    values = np.random.default_rng(0).random((8, 9))

    found = [GradientMagnitude()(Image.of_array(each)).values for each in (values, -values)]

    np.testing.assert_array_equal(*found)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_keeps_the_number_type(dtype):
    image = Image.of_array(np.random.default_rng(0).random((8, 9)).astype(dtype))

    assert GradientMagnitude()(image).values.dtype == dtype


@pytest.mark.parametrize("shape", [(1, 9), (9, 1), (1, 1), (4, 1, 4)])
def test_needs_two_pixels_along_every_axis(shape):
    with pytest.raises(ImageError, match="needs 2 pixels along every axis"):
        GradientMagnitude()(Image.of_array(np.zeros(shape)))
