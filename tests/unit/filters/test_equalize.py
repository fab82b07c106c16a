import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from regframe.catalog import FILTERS
from regframe.errors import PresetError
from regframe.filters.equalize import Equalize
from regframe.image import Image


def scene(top, shape=(48, 64)):
    """Most pixels dark, a few bright."""
    noise = gaussian_filter(np.random.default_rng(6).random(shape), 2)
    return np.round(((noise - noise.min()) / np.ptp(noise)) ** 3 * top)


def test_agrees_with_opencv_on_8_bits():
    cv2 = pytest.importorskip("cv2")
    pixels = scene(255).astype(np.uint8)

    equalised = Equalize()(Image.of_array(pixels))

    # OpenCV rounds to whole levels.
    assert np.abs(equalised.values - cv2.equalizeHist(pixels)).max() <= 0.5001


@pytest.mark.parametrize("top", [255, 16383, 65535])
def test_every_level_gets_the_share_of_darker_pixels(top):
    pixels = scene(top).astype(np.uint16)

    equalised = Equalize()(Image.of_array(pixels)).values

    lowest = np.count_nonzero(pixels == pixels.min())
    for level in np.unique(pixels)[::97]:
        share = (np.count_nonzero(pixels <= level) - lowest) / (pixels.size - lowest)
        np.testing.assert_allclose(equalised[pixels == level], share * top, rtol=1e-6)


def test_spreads_values_evenly():
    values = scene(1.0) * 0 + np.random.default_rng(1).random((48, 64)) ** 4

    equalised = Equalize()(Image.of_array(values))

    counts, _ = np.histogram(equalised.values, 16)
    assert counts.min() > 0.9 * counts.mean()


def test_keeps_the_order_of_values():
    pixels = scene(16383, (9, 10, 11)).astype(np.uint16)

    equalised = Equalize(bins=64)(Image.of_array(pixels)).values

    assert np.all(np.diff(equalised.ravel()[np.argsort(pixels, axis=None)]) >= 0)


def test_keeps_the_range():
    image = Image.of_array(scene(16383).astype(np.uint16) + np.uint16(500))

    assert Equalize()(image).range() == image.range()


def test_counts_under_the_mask_alone():
    pixels = scene(255)
    mask = np.zeros(pixels.shape, bool)
    mask[:, 10:] = True
    image = Image.of_array(pixels).with_mask(mask)
    other = Image.of_array(np.where(mask, pixels, 1e6)).with_mask(mask)

    np.testing.assert_array_equal(Equalize()(image).values[mask], Equalize()(other).values[mask])
    assert Equalize()(other).values.max() <= pixels[mask].max()


def test_leaves_a_constant_image_alone():
    image = Image.of_array(np.full((4, 5), 7.0))

    assert Equalize()(image) is image


def test_needs_two_bins():
    with pytest.raises(PresetError, match="bins: must be at least 2"):
        FILTERS.build({"type": "equalize", "bins": 1})
