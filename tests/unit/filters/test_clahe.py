import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from naive.clahe import clahe
from regframe.catalog import FILTERS
from regframe.errors import PresetError
from regframe.filters.clahe import Clahe
from regframe.image import Image


def scene(shape, top=255.0, seed=8):
    noise = gaussian_filter(np.random.default_rng(seed).random(shape), 2)
    return np.round(((noise - noise.min()) / np.ptp(noise)) ** 2 * top)


@pytest.mark.parametrize(("tiles", "clip_limit", "bins"), [(1, 1.5, 16), (2, 2.0, 32), (4, 40.0, 256)])
def test_agrees_with_the_slow_twin(tiles, clip_limit, bins):
    values = scene((24, 32))

    found = Clahe(tiles=tiles, clip_limit=clip_limit, bins=bins)(Image.of_array(values)).values

    # Sums of shares in another order.
    np.testing.assert_allclose(found, clahe(values, tiles, clip_limit, bins), rtol=1e-12, atol=1e-12 * 255)


@pytest.mark.parametrize("clip_limit", [2.0, 4.0, 40.0])
def test_is_close_to_opencv(clip_limit):
    cv2 = pytest.importorskip("cv2")
    pixels = scene((256, 320)).astype(np.uint8)

    found = Clahe(clip_limit=clip_limit)(Image.of_array(pixels)).values

    theirs = cv2.createCLAHE(clip_limit, (8, 8)).apply(pixels).astype(float)
    # OpenCV spreads counts by whole pixels and rounds levels.
    assert np.abs(found - theirs).mean() < 2
    assert np.abs(found - theirs).max() < 16


def test_brings_out_faint_detail_beside_a_bright_half():
    faint = np.random.default_rng(0).normal(0, 2, (64, 64))
    values = faint + np.where(np.arange(64) < 32, 10.0, 1000.0)

    found = Clahe(clip_limit=20.0)(Image.of_array(values)).values

    contrast = values[:, :24].std() / np.ptp(values)
    assert found[:, :24].std() / np.ptp(found) > 5 * contrast


def test_a_lower_limit_gives_less_contrast():
    image = Image.of_array(scene((64, 64)) / 10)

    spread = [Clahe(clip_limit=limit, tiles=4)(image).values.std() for limit in (1.1, 3.0, 30.0)]

    assert spread == sorted(spread)


@pytest.mark.parametrize("shape", [(37, 53), (3, 5), (1, 1), (1, 40), (12, 13, 14), (1, 9, 10)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_takes_any_shape_and_stays_in_range(shape, dtype):
    values = np.random.default_rng(1).random(shape).astype(dtype)
    image = Image.of_array(values)

    found = Clahe()(image)

    assert found.values.dtype == dtype
    assert found.values.shape == shape
    assert found.values.min() >= values.min()
    assert found.values.max() <= values.max() * (1 + 1e-6)


def test_a_volume_of_equal_slices_is_treated_as_its_slice():
    plane = scene((24, 32))
    volume = np.stack([plane] * 8)

    given = Clahe(tiles=4, bins=32)

    found = given(Image.of_array(volume)).values

    for part in found:
        np.testing.assert_allclose(part, given(Image.of_array(plane)).values, rtol=1e-12, atol=1e-10)


def test_ignores_what_lies_outside_the_mask():
    values = scene((48, 64))
    mask = np.zeros(values.shape, bool)
    mask[:, 16:] = True
    other = np.where(mask, values, values.max())

    found = [Clahe()(Image.of_array(each).with_mask(mask)).values for each in (values, other)]

    np.testing.assert_array_equal(found[0][mask], found[1][mask])


def test_leaves_values_of_unmasked_tiles_nearly_alone():
    values = scene((48, 64))
    mask = np.zeros(values.shape, bool)
    mask[:, 32:] = True
    low, high = values[mask].min(), values[mask].max()

    found = Clahe(tiles=4)(Image.of_array(values).with_mask(mask)).values

    # Tables have 256 steps.
    far = np.clip(values, low, high)[:, :8]
    assert np.abs(found[:, :8] - far).max() <= (high - low) / 255


def test_leaves_a_constant_image_alone():
    image = Image.of_array(np.full((9, 9), 3.0))

    assert Clahe()(image) is image


@pytest.mark.parametrize(
    ("options", "fault"),
    [
        ({"tiles": 0}, "tiles: must be at least 1"),
        ({"clip_limit": 1.0}, "clip_limit: must be greater than 1"),
        ({"bins": 1}, "bins: must be at least 2"),
    ],
)
def test_refuses_impossible_options(options, fault):
    with pytest.raises(PresetError, match=fault):
        FILTERS.build({"type": "clahe", **options})
