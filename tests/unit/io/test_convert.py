import numpy as np
import pytest
import SimpleITK as sitk

from regframe.errors import ImageError
from regframe.geometry import Grid
from regframe.image import Image
from regframe.io import from_sitk, to_sitk

PLANE = Grid((3, 4), (0.5, 2.0), (3.0, -4.0), ((0.8, -0.6), (0.6, 0.8)))
VOLUME = Grid(
    (2, 3, 4), (1.0, 2.0, 3.0), (5.0, 6.0, 7.0), ((0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0))
)


@pytest.mark.parametrize("grid", [PLANE, VOLUME], ids=["plane", "volume"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_comes_back_the_same(grid, dtype):
    image = Image(np.arange(grid.size, dtype=dtype).reshape(grid.shape), grid)

    back = from_sitk(to_sitk(image))

    assert back.grid == grid
    assert back.values.dtype == dtype
    np.testing.assert_array_equal(back.values, image.values)


@pytest.mark.parametrize("grid", [PLANE, VOLUME], ids=["plane", "volume"])
def test_places_points_where_simpleitk_does(grid):
    image = Image(np.zeros(grid.shape), grid)
    index = [0.5, 1.5, 0.25][: grid.dim]

    theirs = to_sitk(image).TransformContinuousIndexToPhysicalPoint(index)

    np.testing.assert_allclose(grid.points(np.array([index[::-1]]))[0], theirs, rtol=0, atol=1e-14)


def test_keeps_stored_numbers_in_raw():
    theirs = sitk.GetImageFromArray(np.arange(12, dtype=np.int32).reshape(3, 4))

    image = from_sitk(theirs, name="ct")

    assert image.name == "ct"
    assert image.raw.dtype == np.int32
    assert image.values.dtype == np.float64


def test_refuses_complex_numbers():
    with pytest.raises(ImageError, match="pixels must be real numbers"):
        from_sitk(sitk.Image([4, 3], sitk.sitkComplexFloat32))


def test_refuses_pixels_of_two_values():
    with pytest.raises(ImageError, match="flow: 2 values a pixel in 2-D"):
        from_sitk(sitk.Image([4, 3], sitk.sitkVectorFloat32, 2), name="flow")
