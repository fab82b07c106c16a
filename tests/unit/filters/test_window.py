import numpy as np
import pytest

from regframe.catalog import FILTERS
from regframe.errors import ImageError, PresetError
from regframe.filters.window import Window
from regframe.image import Image


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_clips_at_both_ends(dtype):
    image = Image.of_array(np.array([[-5.0, 0.0, 3.5], [4.0, 10.0, 11.0]], dtype))

    clipped = Window(low=0.0, high=10.0)(image)

    assert clipped.values.dtype == dtype
    np.testing.assert_array_equal(clipped.values, [[0, 0, 3.5], [4, 10, 10]])


@pytest.mark.parametrize(("low", "high"), [(20.0, 30.0), (-9.0, 1.0)])
def test_tells_a_window_beside_the_image(low, high):
    image = Image.of_array(np.array([[1.0, 20.0]]))

    with pytest.raises(ImageError, match=r"no value lies inside .*from 1 to 20\. Choose"):
        Window(low=low, high=high)(image)


@pytest.mark.parametrize(
    ("options", "fault"),
    [
        ({"low": 5.0, "high": 5.0}, r"`low` must be below `high`\. Got 5 and 5\."),
        ({"low": 5.0}, r"high: is required and missing\. Write high ="),
        ({"low": float("-inf"), "high": 5.0}, "low: must be a finite number"),
    ],
)
def test_refuses_an_impossible_window(options, fault):
    with pytest.raises(PresetError, match=fault):
        FILTERS.build({"type": "window", **options})
