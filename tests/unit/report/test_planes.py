import numpy as np
import pytest

from regframe.geometry import Grid
from regframe.report.planes import planes, tone, views
from support.results import image, ramp, result


def test_tone_spreads_grey_values_from_black_to_white():
    one = image(np.arange(14000, 14400, dtype=np.uint16).reshape(20, 20), "thermal")

    shades = tone(one)(one.values)

    assert shades.min() == 0
    assert shades.max() == 1


def test_tone_is_not_ruled_by_a_hot_pixel():
    pixels = np.full((40, 40), 100, np.uint16)
    pixels[:, 20:] = 120
    pixels[3, 3] = 65535
    one = image(pixels, "thermal")

    shades = tone(one)(one.values)

    assert shades[30, 30] - shades[30, 10] > 0.9


def test_tone_lifts_dark_pictures():
    pixels = np.random.default_rng(1).exponential(3.0, (60, 60)).astype(np.float32)
    pixels[:2] = 100
    one = image(pixels, "night")

    assert tone(one)(one.values).mean() > np.clip(pixels / np.percentile(pixels, 99), 0, 1).mean()


def test_tone_of_a_constant_image_is_finite():
    one = image(np.full((5, 5), 7, np.uint8), "flat")

    assert np.isfinite(tone(one)(one.values)).all()


def test_tone_looks_under_the_mask_alone():
    pixels = ramp((20, 20)).astype(np.float32)
    mask = np.zeros(pixels.shape, bool)
    mask[5:15, 5:15] = True

    one = image(pixels, "masked").with_mask(mask)

    assert tone(one)(pixels[mask]).max() == 1


def test_camera_images_are_seen_at_their_own_pixels():
    grid = Grid.of_shape((12, 16))

    assert views(grid) == [(grid, (12, 16))]


def test_flat_images_are_seen_in_square_pixels():
    one = image(ramp((10, 12)), "slice", spacing=(1.0, 2.5))

    ((grid, shape),) = views(one.grid)

    assert shape == (25, 12)
    assert grid.spacing == (1.0, 1.0)


def test_huge_images_are_seen_at_a_coarser_grid():
    ((grid, shape),) = views(Grid.of_shape((6000, 4000)))

    assert grid.size <= 4_000_000
    assert shape == grid.shape


@pytest.mark.parametrize(("panel", "axes"), [(0, (1, 0)), (1, (2, 0)), (2, (2, 1))])
def test_volumes_are_seen_in_three_middle_cuts(panel, axes):
    one = image(ramp((6, 10, 14)), "volume", spacing=(40.0, 40.0, 80.0))
    extent = np.array(one.grid.spacing) * (np.array(one.grid.shape[::-1]) - 1)

    grid, (height, width) = views(one.grid)[panel]

    assert grid.size == height * width
    assert height * grid.spacing[0] == pytest.approx(extent[axes[0]], abs=2 * grid.spacing[0])
    assert width * grid.spacing[0] == pytest.approx(extent[axes[1]], abs=2 * grid.spacing[0])


def test_the_top_of_a_volume_is_up():
    pixels = np.zeros((8, 8, 8), np.uint8)
    pixels[6:] = 200
    one = image(pixels, "volume")

    _, coronal, sagittal = planes(result(one, one, shift=(0, 0, 0)))

    for plane in (coronal, sagittal):
        assert plane.fixed[0].mean() > plane.fixed[-1].mean()


def test_the_moving_image_is_seen_through_the_warp():
    fixed = image(ramp((12, 16)), "fixed")
    moving = image(np.roll(ramp((12, 16)), 3, axis=1), "moving")

    (plane,) = planes(result(fixed, moving, shift=(3, 0)))

    assert np.allclose(plane.fixed[plane.inside], plane.moving[plane.inside], atol=1e-6)
    assert plane.inside[:, :13].all()
    assert not plane.inside[:, 13:].any()
