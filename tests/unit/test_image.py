import numpy as np
import pytest

from regframe.errors import GeometryError, ImageError
from regframe.geometry import Grid
from regframe.image import Image, as_pixels, grey, is_colour

PIXELS = np.random.default_rng(7).integers(0, 256, (5, 6)).astype(np.uint8)


def test_an_array_lies_on_a_grid_in_pixels():
    image = Image.of_array(PIXELS, name="frame")

    assert image.grid == Grid.of_shape((5, 6))
    assert image.name == "frame"
    assert image.dim == 2
    np.testing.assert_array_equal(image.values, PIXELS)


@pytest.mark.parametrize("dtype", [np.uint8, np.int8, np.uint16, np.int16, np.bool_, np.float16, np.float32])
def test_numbers_that_fit_become_single_precision(dtype):
    assert as_pixels(PIXELS.astype(dtype)).dtype == np.float32


@pytest.mark.parametrize("dtype", [np.uint32, np.int32, np.uint64, np.int64, np.float64])
def test_other_numbers_become_double_precision(dtype):
    assert as_pixels(PIXELS.astype(dtype)).dtype == np.float64


@pytest.mark.parametrize("dtype", [np.complex64, "U4", object])
def test_refuses_what_is_no_number(dtype):
    with pytest.raises(ImageError, match="frame: pixels must be real numbers"):
        as_pixels(PIXELS.astype(dtype), "frame")


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_only_single_precision_rounds(dtype):
    assert Image.of_array(PIXELS.astype(dtype)).rounds == (dtype is np.float32)


def test_keeps_stored_pixels():
    assert Image.of_array(PIXELS).raw is PIXELS


def test_colour_becomes_luma():
    colour = np.array([[[255, 0, 0], [0, 255, 0], [0, 0, 255]]], np.uint8)

    np.testing.assert_allclose(grey(colour), [[76.245, 149.685, 29.07]], rtol=1e-7)


@pytest.mark.parametrize("channels", [3, 4])
def test_grey_in_colour_keeps_its_levels_exactly(channels):
    levels = np.arange(1 << 16, dtype=np.uint16).reshape(256, 256)

    np.testing.assert_array_equal(grey(np.stack([levels] * channels, axis=-1)), levels)


@pytest.mark.parametrize(
    ("shape", "claim"),
    [((4, 5, 3), True), ((4, 5, 4), True), ((4, 5, 2), False), ((4, 5), False), ((4, 5, 6), False)],
)
def test_colour_has_3_or_4_channels(shape, claim):
    assert is_colour(np.zeros(shape)) is claim


def test_range_is_taken_under_the_mask():
    mask = np.zeros((5, 6), bool)
    mask[1, 2] = mask[3, 3] = True
    image = Image.of_array(PIXELS).with_mask(mask)

    assert image.range() == tuple(sorted((float(PIXELS[1, 2]), float(PIXELS[3, 3]))))


def test_takes_a_single_pixel():
    assert Image.of_array(np.array([[5.0]])).range() == (5.0, 5.0)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_rounded_values_have_the_images_type(dtype):
    image = Image.of_array(PIXELS.astype(dtype))

    assert image.with_rounded(np.ones((5, 6), int)).values.dtype == dtype


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_refuses_values_that_are_not_finite(bad):
    values = np.ones((4, 5))
    values[1, 1] = values[2, 2] = bad

    with pytest.raises(ImageError, match=r"frame: 2 of 20 pixels are NaN or infinite\. Replace"):
        Image.of_array(values, name="frame")


@pytest.mark.parametrize("shape", [(0, 5), (5, 0), (0, 4, 4)])
def test_refuses_an_empty_image(shape):
    with pytest.raises(ImageError, match="the image is empty"):
        Image.of_array(np.zeros(shape))


@pytest.mark.parametrize("shape", [(5,), (2, 2, 2, 2)])
def test_refuses_other_than_2_or_3_axes(shape):
    with pytest.raises(GeometryError, match="images have 2 or 3 axes"):
        Image.of_array(np.zeros(shape))


def test_refuses_values_of_another_shape_than_the_grid():
    with pytest.raises(GeometryError, match="do not fit a grid"):
        Image(np.zeros((4, 5)), Grid.of_shape((5, 4)))


def test_refuses_values_that_are_no_pixels():
    with pytest.raises(ImageError, match="values must be float32 or float64"):
        Image(np.zeros((4, 5), int), Grid.of_shape((4, 5)))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("mask", "fault"),
    [
        (np.ones((6, 5), bool), "the mask has shape"),
        (np.zeros((5, 6), bool), "the mask is empty"),
        (np.ones((5, 6), np.uint8), "a mask holds True and False"),
    ],
)
def test_refuses_a_mask_that_cannot_be_used(mask, fault):
    with pytest.raises(GeometryError, match=fault):
        Image.of_array(PIXELS).with_mask(mask)
