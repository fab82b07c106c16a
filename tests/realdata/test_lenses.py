"""A wide thermal lens: what no homography fits, a distortion coefficient does."""

import pytest

from regframe import register
from regframe.transforms.projective_radial import ProjectiveRadial
from support.raw_pairs import raw_pairs

pytestmark = pytest.mark.slow


def test_a_wide_lens_is_found_and_fitted_far_below_the_similarity_floor(data):
    (pair,) = raw_pairs(data, ("metu_vistir_raw",), ("cloudy5_00007",))

    result = register("visual-thermal-radial", pair.fixed, pair.moving)

    assert isinstance(result.warp.transform, ProjectiveRadial)
    assert result.choices[-1].kept
    # Barrel distortion, as wide lenses have it.
    assert -0.25 < result.warp.params[8] < -0.05
    # The landmarks are good to 1 or 2 pixels; no similarity comes nearer than 3.46.
    assert pair.error(result.warp) < 1.5
