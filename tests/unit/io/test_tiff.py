import numpy as np
import pytest
from PIL import Image as Pillow

from regframe.errors import ImageError
from regframe.io import read
from regframe.io import tiff as rewriting
from support import tiffs
from support.tiffs import tiff, tiled

TYPES = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f2", "f4", "f8"]


@pytest.fixture
def stored(tmp_path):
    """Writes the bytes of a TIFF file and reads it: the stored pixels."""

    def write_and_read(data):
        path = tmp_path / "frame.tiff"
        path.write_bytes(data)
        return read(path).raw

    return write_and_read


def picture(dtype, shape=(7, 10)):
    rng = np.random.default_rng(3)
    return (rng.random(shape) * 120 - (60 if dtype[0] in "if" else 0)).astype(dtype)


@pytest.mark.parametrize("photometric", [None, 0, 1])
@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("dtype", TYPES)
def test_reads_every_number_type_as_it_is_stored(stored, dtype, order, photometric):
    pixels = picture(dtype)

    found = stored(tiff([pixels], {tiffs.PHOTOMETRIC: photometric}, order))

    np.testing.assert_array_equal(found, pixels)


def test_keeps_14_bits_of_a_thermal_frame_without_photometric_tag(stored):
    pixels = np.random.default_rng(0).integers(7000, 7400, (16, 20)).astype(np.uint16)

    found = stored(tiff([pixels], {tiffs.PHOTOMETRIC: None}))

    assert found.dtype == np.uint16
    np.testing.assert_array_equal(found, pixels)


@pytest.mark.parametrize("photometric", [None, 2])
@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("dtype", ["u1", "u2", "f4", "f8"])
def test_reads_colour_of_every_depth(stored, dtype, channels, photometric):
    pixels = picture(dtype, (6, 9, channels))

    found = stored(tiff([pixels], {tiffs.PHOTOMETRIC: photometric}))

    np.testing.assert_array_equal(found, pixels)


@pytest.mark.parametrize("dtype", ["u1", "u2", "f2", "f4", "f8"])
def test_drops_the_alpha_of_grey(stored, dtype):
    pixels = picture(dtype, (6, 9, 2))

    found = stored(tiff([pixels]))

    np.testing.assert_array_equal(found, pixels[..., 0])


@pytest.mark.parametrize("dtype", ["u2", "f8"])
@pytest.mark.parametrize("order", "<>")
def test_reads_big_tiff(stored, dtype, order):
    pixels = picture(dtype)

    found = stored(tiff([pixels], {tiffs.PHOTOMETRIC: None}, order, big=True))

    np.testing.assert_array_equal(found, pixels)


@pytest.mark.parametrize("photometric", [None, 1])
@pytest.mark.parametrize("dtype", ["u1", "u2", "f4", "f8"])
def test_reads_pages_as_a_volume(stored, dtype, photometric):
    pages = [picture(dtype), picture(dtype)[::-1], picture(dtype)[:, ::-1]]

    found = stored(tiff(pages, {tiffs.PHOTOMETRIC: photometric}))

    np.testing.assert_array_equal(found, np.stack(pages))


def test_leaves_out_a_page_of_another_size(stored):
    preview = picture("u2", (3, 5))

    found = stored(tiff([picture("u2"), preview]))

    np.testing.assert_array_equal(found, picture("u2"))


@pytest.mark.parametrize("compression", ["tiff_lzw", "tiff_adobe_deflate", "packbits"])
def test_reads_compressed_pages_without_photometric_tag(stored, tmp_path, compression):
    pixels = picture("u2")
    path = tmp_path / "packed.tif"
    Pillow.fromarray(pixels).save(path, compression=compression)
    data = path.read_bytes()
    entry = data.index(bytes([6, 1, 3, 0, 1, 0, 0, 0, 1, 0, 0, 0]))
    # A tag that readers skip takes the photometric one's place.
    odd = data[:entry] + bytes([5, 1]) + data[entry + 2 :]

    found = stored(odd)

    np.testing.assert_array_equal(found, pixels)


@pytest.mark.parametrize("compression", ["raw", "group4"])
def test_reads_1_bit_as_0_and_255(stored, tmp_path, compression):
    claims = picture("u1") > 60
    path = tmp_path / "bits.tif"
    Pillow.fromarray(claims).save(path, compression=compression)

    found = stored(path.read_bytes())

    np.testing.assert_array_equal(found, claims * np.uint8(255))


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("shape", [(7, 10), (32, 16), (33, 50), (40, 50, 3), (20, 40, 2)])
@pytest.mark.parametrize("dtype", ["u1", "u2", "f4", "f8"])
def test_reads_tiles(stored, dtype, shape, order):
    pixels = picture(dtype, shape)

    found = stored(tiled(pixels, order))

    np.testing.assert_array_equal(found, pixels[..., 0] if shape[2:] == (2,) else pixels)


def test_refuses_what_is_read_with_fewer_bits():
    plan = rewriting.plan(tiff([picture("u2")]), "frame")

    with pytest.raises(ImageError, match=r"frame: its 16-bit samples .* only 8 bits .*Save it as"):
        plan.restore(picture("u1"), "frame")


def test_refuses_packed_samples(stored):
    with pytest.raises(ImageError, match=r"samples of 12 bits, integer, cannot be read\. Save it with"):
        stored(tiff([picture("u2")], {tiffs.BITS: 12}))


def test_refuses_complex_samples(stored):
    with pytest.raises(ImageError, match="samples of 64 bits, complex, cannot be read"):
        stored(tiff([picture("f4").astype(np.complex64)]))


@pytest.mark.parametrize(
    ("tag", "value", "how"), [(tiffs.PREDICTOR, 2, "a predictor"), (tiffs.PLANAR, 2, "planes")]
)
def test_refuses_wide_samples_that_cannot_be_split(stored, tag, value, how):
    with pytest.raises(ImageError, match=how):
        stored(tiff([picture("f8", (6, 9, 3))], {tag: value}))


@pytest.mark.parametrize("dtype", ["u2", "f8"])
@pytest.mark.parametrize("share", [0.02, 0.1, 0.5, 0.97])
def test_tells_a_truncated_file(stored, dtype, share):
    data = tiff([picture(dtype, (20, 30))])

    with pytest.raises(ImageError, match="truncated"):
        stored(data[: int(len(data) * share)])


def test_refuses_pages_in_a_circle(stored):
    data = bytearray(tiff([picture("u2")]))
    tags = int.from_bytes(data[8:10], "little")
    data[10 + 12 * tags : 14 + 12 * tags] = (8).to_bytes(4, "little")

    with pytest.raises(ImageError, match="damaged"):
        stored(bytes(data))


@pytest.mark.parametrize("dtype", ["u8", "i8", "f8"])
def test_reads_what_it_encodes(stored, dtype):
    pixels = picture(dtype)

    found = stored(rewriting.encode(pixels))

    np.testing.assert_array_equal(found, pixels)
