import numpy as np
import pytest
import SimpleITK as sitk

from regframe.catalog import FILTERS
from regframe.errors import PresetError
from regframe.filters.gaussian import Gaussian
from regframe.geometry import Grid
from regframe.image import Image
from regframe.io import to_sitk

UPRIGHT = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
VOLUME = Grid((9, 10, 12), (1.0, 2.0, 0.5), (0.0, 0.0, 0.0), UPRIGHT)


@pytest.mark.parametrize("grid", [Grid.of_shape((20, 24)), VOLUME], ids=["plane", "volume"])
def test_smooths_as_simpleitk_does_by_a_physical_width(grid):
    image = Image(np.random.default_rng(0).random(grid.shape).astype(np.float32), grid)

    found = Gaussian(sigma=1.5)(image)

    theirs = sitk.GetArrayFromImage(sitk.SmoothingRecursiveGaussian(to_sitk(image), 1.5))
    assert found.values.dtype == np.float32
    np.testing.assert_allclose(found.values, theirs, atol=1e-7)


def test_needs_a_width():
    with pytest.raises(PresetError, match="sigma: must be greater than 0"):
        FILTERS.build({"type": "gaussian", "sigma": 0.0})
