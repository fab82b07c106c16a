import numpy as np
import pytest

from regframe.catalog import FILTERS
from regframe.errors import PresetError
from regframe.filters.grey import Grey
from regframe.geometry import Grid
from regframe.image import Image

COLOUR = np.random.default_rng(4).integers(0, 256, (6, 7, 4)).astype(np.uint8)


@pytest.mark.parametrize(("channel", "index"), [("red", 0), ("green", 1), ("blue", 2)])
@pytest.mark.parametrize("channels", [3, 4])
def test_takes_one_channel(channel, index, channels):
    image = Image.of_array(COLOUR[..., :channels])

    chosen = Grey(channel=channel)(image)

    assert chosen.values.dtype == np.float32
    np.testing.assert_array_equal(chosen.values, COLOUR[..., index])


def test_takes_luma_by_default():
    image = Image.of_array(COLOUR)

    np.testing.assert_array_equal(Grey()(image).values, image.values)


@pytest.mark.parametrize(
    "image",
    [
        Image.of_array(COLOUR[..., 0]),
        Image.of_array(np.zeros((4, 5, 6))),
        Image(np.zeros((5, 6)), Grid.of_shape((5, 6))),
    ],
    ids=["plane", "volume", "without raw"],
)
def test_leaves_grey_images_alone(image):
    assert Grey(channel="red")(image) is image


def test_knows_its_channels():
    with pytest.raises(PresetError, match="Did you mean 'green'"):
        FILTERS.build({"type": "grey", "channel": "greeen"})
