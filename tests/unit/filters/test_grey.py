import numpy as np
import pytest

from regframe.catalog import FILTERS
from regframe.errors import ImageError, PresetError
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


def spot(shape=(96, 128)):
    """A smooth hill, 0 at the rim and 1 at the top, with a dip in it."""
    y, x = np.mgrid[: shape[0], : shape[1]]
    hill = np.exp(-((x - 60) ** 2 + (y - 50) ** 2) / 900.0) - 0.4 * np.exp(
        -((x - 66) ** 2 + (y - 50) ** 2) / 90.0
    )
    return np.clip((hill - hill.min()) / np.ptp(hill), 0.0, 1.0)


def painted(values, stops):
    """An 8-bit picture by a palette of equally spaced colours."""
    places = np.linspace(0.0, 1.0, len(stops))
    channels = [np.interp(values, places, [stop[channel] for stop in stops]) for channel in range(3)]
    return Image.of_array(np.round(np.stack(channels, axis=-1)).astype(np.uint8))


RAINBOW = [(0, 0, 0), (0, 0, 255), (0, 255, 255), (255, 255, 0), (255, 0, 0), (255, 0, 255)]
IRON = [(0, 0, 0), (120, 0, 140), (230, 90, 0), (255, 220, 60), (255, 255, 255)]


@pytest.mark.parametrize("stops", [RAINBOW, IRON], ids=["rainbow", "iron"])
def test_undoes_a_palette_that_it_does_not_know(stops):
    values = spot()

    found = Grey(channel="palette")(painted(values, stops)).values

    # The way along the stops, what an ideal reader of this palette would say.
    lengths = np.linalg.norm(np.diff(np.array(stops, float), axis=0), axis=1)
    way = np.interp(values, np.linspace(0.0, 1.0, len(stops)), np.concatenate([[0.0], np.cumsum(lengths)]))
    # Cells are 8 levels wide, and where the palette turns a corner the curve through their means cuts it.
    assert np.abs(found - way).max() < 0.03 * lengths.sum()


def test_keeps_the_order_where_luma_loses_it():
    values = spot()
    image = painted(values, RAINBOW)

    luma, palette = (Grey(channel=channel)(image).values for channel in ("luma", "palette"))

    assert np.corrcoef(luma.ravel(), values.ravel())[0, 1] < 0.9
    assert np.corrcoef(palette.ravel(), values.ravel())[0, 1] > 0.99


def test_palette_of_grey_stored_as_colour_is_that_grey():
    levels = np.round(255.0 * spot()).astype(np.uint8)
    image = Image.of_array(np.stack([levels] * 3, axis=-1))

    found = Grey(channel="palette")(image).values

    np.testing.assert_allclose(found, np.sqrt(3.0) * (levels - float(levels.min())), atol=1e-3)


@pytest.mark.parametrize("kind", [np.uint16, np.float32])
def test_palette_has_the_unit_of_the_channels(kind):
    eight = painted(spot(), RAINBOW)
    large = Image.of_array(eight.raw.astype(kind) * kind(100))

    small, found = (Grey(channel="palette")(image).values for image in (eight, large))

    np.testing.assert_allclose(found, 100.0 * small, rtol=1e-3, atol=1.0)


def test_palette_ignores_alpha():
    plain = painted(spot(), RAINBOW)
    alpha = np.random.default_rng(2).integers(0, 256, plain.values.shape).astype(np.uint8)
    veiled = Image.of_array(np.concatenate([plain.raw, alpha[..., None]], axis=-1))

    found = Grey(channel="palette")(veiled).values

    np.testing.assert_array_equal(found, Grey(channel="palette")(plain).values)


def test_palette_of_one_colour_is_one_value():
    image = Image.of_array(np.full((5, 6, 3), 7, np.uint8))

    assert (Grey(channel="palette")(image).values == 0.0).all()


def test_palette_refuses_a_photograph():
    noise = np.random.default_rng(3).integers(0, 256, (64, 64, 3)).astype(np.uint8)

    with pytest.raises(ImageError, match=r'too many for a palette.*channel = "luma"'):
        Grey(channel="palette")(Image.of_array(noise, name="street"))
