import numpy as np
import pytest

from regframe.catalog import FILTERS
from regframe.errors import ImageError, PresetError
from regframe.filters.percentile_clip import PercentileClip
from regframe.image import Image


def thermal():
    """14-bit counts of a dull scene with three hot pixels and a dead one."""
    counts = np.random.default_rng(2).integers(7000, 7400, (60, 80)).astype(np.uint16)
    counts[10, 10:13], counts[40, 40] = 16383, 0
    return Image.of_array(counts)


def test_takes_hot_and_dead_pixels_out_of_the_range():
    low, high = PercentileClip(low=0.5, high=99.5)(thermal()).range()

    assert 7000 <= low <= 7010
    assert 7390 <= high <= 7400


def test_leaves_values_between_the_percentiles():
    image = thermal()

    clipped = PercentileClip()(image)

    low, high = clipped.range()
    between = (image.values >= low) & (image.values <= high)
    np.testing.assert_array_equal(clipped.values[between], image.values[between])


def test_clips_at_values_that_the_image_has():
    image = thermal()

    clipped = PercentileClip(low=3.3, high=77.7)(image)

    assert set(clipped.range()) <= set(image.values.ravel())


def test_changes_nothing_from_0_to_100():
    image = thermal()

    np.testing.assert_array_equal(PercentileClip(low=0, high=100)(image).values, image.values)


def test_counts_under_the_mask_alone():
    mask = np.zeros((60, 80), bool)
    mask[:30] = True
    image = thermal().with_values((np.arange(4800) % 80).reshape(60, 80).astype(np.float32)).with_mask(mask)
    brighter = image.with_values(np.where(mask, image.values, np.float32(1e4)))

    clipped = PercentileClip(low=10, high=90)(brighter)

    assert clipped.range() == PercentileClip(low=10, high=90)(image).range()
    assert clipped.values.max() < 80


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_keeps_the_number_type(dtype):
    image = thermal()
    typed = Image(image.values.astype(dtype), image.grid)

    assert PercentileClip()(typed).values.dtype == dtype


def test_tells_that_one_value_would_be_left():
    values = np.zeros((20, 20), np.float32)
    values[0, 0] = 9

    with pytest.raises(ImageError, match=r"percentiles 0\.5 and 99\.5 are both 0.*Widen"):
        PercentileClip()(Image.of_array(values))


@pytest.mark.parametrize(
    ("options", "fault"),
    [
        ({"low": 99.0, "high": 1.0}, r"`low` must be below `high`\. Got 99 and 1\."),
        ({"low": -1.0}, "low: must be at least 0"),
        ({"high": 101.0}, "high: must be at most 100"),
        ({"low": float("nan")}, "low: must be"),
        ({"hihg": 99.0}, "Did you mean 'high'"),
    ],
)
def test_refuses_impossible_percentiles(options, fault):
    with pytest.raises(PresetError, match=fault):
        FILTERS.build({"type": "percentile-clip", **options})
