import gzip
import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from PIL import Image as Pillow
from scipy.ndimage import gaussian_filter

from regframe.errors import GeometryError, ImageError
from regframe.geometry import Grid
from regframe.image import Image
from regframe.io import coerce, digest, read, read_mask, write

TURN = (0.8, -0.6, 0.6, 0.8)
MEDICAL = (".nrrd", ".mha", ".mhd", ".nii", ".nii.gz")


def frame(dtype=np.uint8, shape=(40, 60), top=255):
    noise = gaussian_filter(np.random.default_rng(5).random(shape), [2, 2] + [0] * (len(shape) - 2))
    return ((noise - noise.min()) / np.ptp(noise) * top).astype(dtype)


def truncated(path, share):
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * share)])


@pytest.mark.parametrize("suffix", [".png", ".bmp", ".tif", ".tiff", ".PNG", ".TIF"])
def test_reads_8_bit_grey(tmp_path, suffix):
    Pillow.fromarray(frame()).save(tmp_path / f"frame{suffix}")

    image = read(tmp_path / f"frame{suffix}")

    assert image.values.dtype == np.float32
    assert image.raw.dtype == np.uint8
    np.testing.assert_array_equal(image.values, frame())
    np.testing.assert_array_equal(image.raw, frame())


@pytest.mark.parametrize("suffix", [".png", ".tiff"])
def test_keeps_14_bits_in_16(tmp_path, suffix):
    pixels = frame(np.uint16, top=16383)
    Pillow.fromarray(pixels).save(tmp_path / f"frame{suffix}")

    image = read(tmp_path / f"frame{suffix}")

    np.testing.assert_array_equal(image.values, pixels)
    np.testing.assert_array_equal(image.raw, pixels)


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".tiff", ".bmp"])
def test_ignores_the_resolution_that_a_picture_claims(tmp_path, suffix):
    Pillow.fromarray(frame()).save(tmp_path / f"frame{suffix}", dpi=(300, 300))

    image = read(tmp_path / f"frame{suffix}")

    assert image.grid == Grid.of_shape((40, 60))


def test_reads_jpeg_nearly_as_it_was(tmp_path):
    Pillow.fromarray(frame()).save(tmp_path / "frame.jpg", quality=95)

    image = read(tmp_path / "frame.jpg")

    assert np.abs(image.values - frame()).max() <= 6


def test_colour_becomes_grey_and_stays_in_raw(tmp_path):
    colour = np.stack([frame(), frame()[::-1], frame()[:, ::-1]], axis=-1)
    Pillow.fromarray(colour).save(tmp_path / "frame.png")

    image = read(tmp_path / "frame.png")

    np.testing.assert_array_equal(image.raw, colour)
    np.testing.assert_allclose(image.values, colour @ [0.299, 0.587, 0.114], rtol=1e-6)


def test_ignores_alpha(tmp_path):
    colour = np.stack([frame(), frame(), frame(), frame()[::-1]], axis=-1)
    Pillow.fromarray(colour).save(tmp_path / "frame.png")

    image = read(tmp_path / "frame.png")

    np.testing.assert_array_equal(image.values, frame())


def test_reads_grey_with_alpha(tmp_path):
    both = np.stack([frame(), frame()[::-1]], axis=-1)
    Pillow.fromarray(both, "LA").save(tmp_path / "frame.png")

    image = read(tmp_path / "frame.png")

    np.testing.assert_array_equal(image.raw, frame())


@pytest.mark.parametrize("suffix", [".png", ".bmp"])
def test_reads_a_palette_as_its_colours(tmp_path, suffix):
    colour = np.stack([frame(), frame()[::-1], frame()[:, ::-1]], axis=-1)
    palette = Pillow.fromarray(colour).quantize(16)
    palette.save(tmp_path / f"frame{suffix}")

    image = read(tmp_path / f"frame{suffix}")

    np.testing.assert_array_equal(image.raw, np.asarray(palette.convert("RGB")))


@pytest.mark.parametrize("suffix", [".png", ".bmp"])
def test_reads_1_bit_as_0_and_255(tmp_path, suffix):
    Pillow.fromarray(frame() > 99).save(tmp_path / f"frame{suffix}")

    image = read(tmp_path / f"frame{suffix}")

    np.testing.assert_array_equal(image.raw, (frame() > 99) * np.uint8(255))


def test_reads_colour_of_16_bits(tmp_path):
    colour = np.stack([frame(np.uint16, top=60000)] * 3, axis=-1)
    write(colour, Grid.of_shape((40, 60)), tmp_path / "frame.png")

    image = read(tmp_path / "frame.png")

    np.testing.assert_array_equal(image.raw, colour)


def test_reads_a_file_under_another_picture_formats_suffix(tmp_path):
    Pillow.fromarray(frame()).save(tmp_path / "frame.bmp")
    (tmp_path / "frame.bmp").rename(tmp_path / "frame.jpg")

    image = read(tmp_path / "frame.jpg")

    np.testing.assert_array_equal(image.raw, frame())


@pytest.mark.parametrize("suffix", MEDICAL)
def test_keeps_the_geometry_of_a_plane(tmp_path, suffix):
    theirs = sitk.GetImageFromArray(frame(np.int16))
    theirs.SetSpacing((0.5, 2.0))
    theirs.SetOrigin((3.0, -4.0))
    theirs.SetDirection(TURN)
    sitk.WriteImage(theirs, str(tmp_path / f"slice{suffix}"))

    grid = read(tmp_path / f"slice{suffix}").grid

    assert grid.shape == (40, 60)
    np.testing.assert_allclose(grid.spacing, (0.5, 2.0), rtol=1e-6)
    np.testing.assert_allclose(grid.origin, (3.0, -4.0), rtol=1e-6)
    # NIfTI keeps the direction as a quaternion in single precision.
    np.testing.assert_allclose(np.ravel(grid.direction), TURN, atol=1e-6)


@pytest.mark.parametrize("suffix", MEDICAL)
def test_keeps_the_geometry_of_a_volume(tmp_path, suffix):
    pixels = np.arange(120, dtype=np.float32).reshape(4, 5, 6)
    theirs = sitk.GetImageFromArray(pixels)
    theirs.SetSpacing((1.0, 2.0, 3.0))
    theirs.SetOrigin((10.0, 20.0, -30.0))
    theirs.SetDirection((0, 0, -1, 1, 0, 0, 0, 1, 0))
    sitk.WriteImage(theirs, str(tmp_path / f"volume{suffix}"))

    image = read(tmp_path / f"volume{suffix}")

    corner = theirs.TransformIndexToPhysicalPoint((5, 4, 3))
    np.testing.assert_array_equal(image.values, pixels)
    np.testing.assert_allclose(image.grid.points(np.array([[3.0, 4.0, 5.0]]))[0], corner, rtol=1e-6)


@pytest.mark.parametrize("suffix", [".mha", ".mhd", ".nrrd"])
def test_reads_compressed_volumes(tmp_path, suffix):
    theirs = sitk.GetImageFromArray(frame(np.uint16))
    sitk.WriteImage(theirs, str(tmp_path / f"slice{suffix}"), useCompression=True)

    image = read(tmp_path / f"slice{suffix}")

    np.testing.assert_array_equal(image.raw, frame(np.uint16))


def test_compressed_nifti_is_not_mixed_up_with_its_neighbour(tmp_path):
    write(frame(), Grid.of_shape((40, 60)), tmp_path / "slice.nii")
    write(frame()[::-1], Grid.of_shape((40, 60)), tmp_path / "slice.nii.gz")

    image = read(tmp_path / "slice.nii.gz")

    np.testing.assert_array_equal(image.raw, frame()[::-1])


@pytest.mark.parametrize("size", [(6, 5, 1), (6, 5, 1, 1)])
def test_drops_last_axes_of_one_point(tmp_path, size):
    theirs = sitk.Image(size, sitk.sitkFloat32)
    theirs.SetSpacing((1.0, 2.0, 3.0, 1.0)[: len(size)])
    sitk.WriteImage(theirs, str(tmp_path / "slice.nrrd"))

    image = read(tmp_path / "slice.nrrd")

    assert image.grid.shape == (5, 6)
    assert image.grid.spacing == (1.0, 2.0)


def test_refuses_a_tilted_slice(tmp_path):
    theirs = sitk.Image([6, 5, 1], sitk.sitkUInt8)
    theirs.SetDirection((1, 0, 0, 0, 0, -1, 0, 1, 0))
    sitk.WriteImage(theirs, str(tmp_path / "slice.nrrd"))

    with pytest.raises(ImageError, match=r"single slice that is tilted .*2-D"):
        read(tmp_path / "slice.nrrd")


def test_refuses_a_series_of_volumes(tmp_path):
    sitk.WriteImage(sitk.Image([6, 5, 4, 3], sitk.sitkUInt8), str(tmp_path / "series.nrrd"))

    with pytest.raises(ImageError, match=r"2 or 3 axes\. Got 4, of size \(6, 5, 4, 3\).* Take one volume"):
        read(tmp_path / "series.nrrd")


@pytest.mark.parametrize("channels", [2, 3])
def test_refuses_vectors_in_a_volume(tmp_path, channels):
    sitk.WriteImage(sitk.Image([6, 5, 4], sitk.sitkVectorFloat32, channels), str(tmp_path / "field.nrrd"))

    with pytest.raises(ImageError, match=f"{channels} values a pixel in 3-D"):
        read(tmp_path / "field.nrrd")


def test_reads_colour_with_geometry(tmp_path):
    colour = np.stack([frame(), frame()[::-1], frame()[:, ::-1]], axis=-1)
    grid = Grid((40, 60), (0.5, 0.25), (1.0, 2.0), ((1.0, 0.0), (0.0, 1.0)))
    write(colour, grid, tmp_path / "slide.mha")

    image = read(tmp_path / "slide.mha")

    assert image.grid == grid
    np.testing.assert_array_equal(image.raw, colour)


def test_reads_a_single_pixel(tmp_path):
    Pillow.fromarray(np.array([[7]], np.uint8)).save(tmp_path / "dot.png")

    image = read(tmp_path / "dot.png")

    np.testing.assert_array_equal(image.values, [[7.0]])


def test_is_called_by_its_path(tmp_path):
    Pillow.fromarray(frame()).save(tmp_path / "frame.png")

    assert read(tmp_path / "frame.png").name == str(tmp_path / "frame.png")
    assert read(tmp_path / "frame.png", name="fixed").name == "fixed"


def test_tells_a_name_that_no_file_can_have(tmp_path):
    with pytest.raises(ImageError, match="there is no such file"):
        read(tmp_path / f"{'x' * 300}.png")


def test_tells_a_missing_file(tmp_path):
    with pytest.raises(ImageError, match=r"none\.png: there is no such file\. Check"):
        read(tmp_path / "none.png")


def test_tells_a_folder(tmp_path):
    with pytest.raises(ImageError, match="this is a folder"):
        read(tmp_path)


def test_tells_an_empty_file(tmp_path):
    (tmp_path / "frame.png").touch()

    with pytest.raises(ImageError, match="the file is empty"):
        read(tmp_path / "frame.png")


@pytest.mark.parametrize("name", ["frame.xyz", "frame"])
def test_lists_known_suffixes(tmp_path, name):
    (tmp_path / name).write_text("pixels")

    with pytest.raises(ImageError, match=r"no image format has the suffix .*Known: \.png, .*\.nii\.gz"):
        read(tmp_path / name)


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".bmp", ".tif", *MEDICAL])
def test_tells_text_from_an_image(tmp_path, suffix):
    (tmp_path / f"frame{suffix}").write_text("hello, I am no image, although I am quite long\n" * 20)

    with pytest.raises(ImageError, match=r"no image|no NIfTI|damaged") as fault:
        read(tmp_path / f"frame{suffix}")

    assert "\n" not in str(fault.value)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.97])
@pytest.mark.parametrize("suffix", [".png", ".jpg", ".bmp", ".tif", ".nrrd", ".mha", ".nii", ".nii.gz"])
def test_tells_a_truncated_file_in_one_line(tmp_path, suffix, share, capfd):
    path = tmp_path / f"frame{suffix}"
    write(frame(), Grid.of_shape((40, 60)), path)
    truncated(path, share)

    with pytest.raises(ImageError, match="truncated") as fault:
        read(path)

    assert "\n" not in str(fault.value)
    assert capfd.readouterr() == ("", "")


def test_tells_a_truncated_progressive_jpeg(tmp_path):
    Pillow.fromarray(frame()).save(tmp_path / "frame.jpg", progressive=True)
    truncated(tmp_path / "frame.jpg", 0.6)

    with pytest.raises(ImageError, match="truncated"):
        read(tmp_path / "frame.jpg")


def test_tells_truncated_data_beside_a_header(tmp_path):
    sitk.WriteImage(sitk.GetImageFromArray(frame()), str(tmp_path / "slice.mhd"))
    truncated(tmp_path / "slice.raw", 0.5)

    with pytest.raises(ImageError, match="truncated"):
        read(tmp_path / "slice.mhd")


def test_tells_plain_nifti_under_the_suffix_of_compressed(tmp_path):
    write(frame(), Grid.of_shape((40, 60)), tmp_path / "slice.nii")
    (tmp_path / "slice.nii").rename(tmp_path / "slice.nii.gz")

    with pytest.raises(ImageError, match="Not a gzipped file"):
        read(tmp_path / "slice.nii.gz")


def test_tells_compressed_text_from_nifti(tmp_path):
    (tmp_path / "slice.nii.gz").write_bytes(gzip.compress(b"hello" * 200))

    with pytest.raises(ImageError, match="no NIfTI file"):
        read(tmp_path / "slice.nii.gz")


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_refuses_pixels_that_are_not_finite(tmp_path, bad):
    pixels = frame(np.float32)
    pixels[3, 4] = bad
    write(pixels, Grid.of_shape((40, 60)), tmp_path / "heat.tiff")

    with pytest.raises(ImageError, match="1 of 2400 pixels are NaN or infinite"):
        read(tmp_path / "heat.tiff")


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root may open every file")
def test_tells_a_file_without_permission(tmp_path):
    Pillow.fromarray(frame()).save(tmp_path / "frame.png")
    (tmp_path / "frame.png").chmod(0)

    with pytest.raises(ImageError, match="cannot be opened"):
        read(tmp_path / "frame.png")


def test_reads_in_several_threads_without_mixing_their_output(tmp_path, capfd):
    path = tmp_path / "frame.jpg"
    Pillow.fromarray(frame()).save(path)
    truncated(path, 0.5)
    faults = []

    def attempt():
        try:
            read(path)
        except ImageError as fault:
            faults.append(str(fault))

    threads = [threading.Thread(target=attempt) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    print("still here")  # noqa: T201 -- standard output must be as it was

    assert len(faults) == 8
    assert all("Premature end" in fault for fault in faults)
    assert capfd.readouterr() == ("still here\n", "")


def test_importing_loads_no_decoder():
    code = "import sys, regframe.io; print({'SimpleITK', 'PIL'} & set(sys.modules))"

    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    assert found.stdout == "set()\n"


class TestMask:
    grid = Grid.of_shape((40, 60))

    def test_counts_what_is_not_0(self, tmp_path):
        write((frame() > 99).astype(np.uint8), self.grid, tmp_path / "mask.png")

        np.testing.assert_array_equal(read_mask(tmp_path / "mask.png", self.grid), frame() > 99)

    def test_counts_colour_that_is_not_black(self, tmp_path):
        colour = np.zeros((40, 60, 3), np.uint8)
        colour[5, 6, 2] = 1
        write(colour, self.grid, tmp_path / "mask.png")

        mask = read_mask(tmp_path / "mask.png", self.grid)

        assert np.argwhere(mask).tolist() == [[5, 6]]

    def test_must_have_the_images_shape(self, tmp_path):
        write(frame(), self.grid, tmp_path / "mask.png")

        with pytest.raises(GeometryError, match=r"shape \(40, 60\), the image \(40, 61\)"):
            read_mask(tmp_path / "mask.png", Grid.of_shape((40, 61)))

    def test_must_not_be_empty(self, tmp_path):
        write(frame() * 0, self.grid, tmp_path / "mask.png")

        with pytest.raises(GeometryError, match="the mask is empty"):
            read_mask(tmp_path / "mask.png", self.grid)

    def test_must_not_be_blurred_by_its_format(self, tmp_path):
        write(frame(), self.grid, tmp_path / "mask.jpg")

        with pytest.raises(ImageError, match="JPEG blurs a mask's border"):
            read_mask(tmp_path / "mask.jpg", self.grid)

    def test_must_lie_where_the_image_does(self, tmp_path):
        write(frame(), self.grid, tmp_path / "mask.nrrd")
        shifted = Grid((40, 60), (1.0, 1.0), (5.0, 0.0), self.grid.direction)

        with pytest.raises(GeometryError, match="up to 5 pixels from the image's"):
            read_mask(tmp_path / "mask.nrrd", shifted)

    def test_may_be_a_picture_for_a_medical_image(self, tmp_path):
        write(frame() > 99, self.grid, tmp_path / "mask.png")
        elsewhere = Grid((40, 60), (0.5, 0.5), (5.0, 0.0), self.grid.direction)

        assert read_mask(tmp_path / "mask.png", elsewhere).sum() == (frame() > 99).sum()


class TestCoerce:
    def test_returns_an_image_as_it_is(self):
        image = Image.of_array(frame())

        assert coerce(image, "fixed") is image

    @pytest.mark.parametrize("kind", [str, Path])
    def test_reads_a_path(self, tmp_path, kind):
        Pillow.fromarray(frame()).save(tmp_path / "frame.png")

        image = coerce(kind(tmp_path / "frame.png"), "fixed")

        assert image.name == str(tmp_path / "frame.png")
        np.testing.assert_array_equal(image.raw, frame())

    def test_names_an_array(self):
        image = coerce(frame(), "moving")

        assert image.name == "moving"
        assert image.grid == Grid.of_shape((40, 60))

    def test_keeps_the_geometry_of_a_simpleitk_image(self):
        theirs = sitk.GetImageFromArray(frame())
        theirs.SetOrigin((7.0, 8.0))

        image = coerce(theirs, "moving")

        assert image.name == "moving"
        assert image.grid.origin == (7.0, 8.0)

    @pytest.mark.parametrize("thing", [[[1, 2], [3, 4]], None, 5])
    def test_refuses_other_things(self, thing):
        with pytest.raises(ImageError, match=r"fixed: an image is a path, .*Got (list|NoneType|int)\. Make"):
            coerce(thing, "fixed")

    @pytest.mark.parametrize("array", [np.zeros(5), np.zeros((2, 2, 2, 2))])
    def test_refuses_arrays_of_other_dimensions(self, array):
        with pytest.raises(GeometryError, match="2 or 3 axes"):
            coerce(array, "fixed")


class TestDigest:
    def test_is_the_same_for_the_same_pixels(self, tmp_path):
        write(frame(), Grid.of_shape((40, 60)), tmp_path / "frame.png")

        assert digest(read(tmp_path / "frame.png")) == digest(Image.of_array(frame()))

    def test_does_not_depend_on_the_order_in_memory(self):
        assert digest(Image.of_array(np.asfortranarray(frame()))) == digest(Image.of_array(frame()))

    @pytest.mark.parametrize(
        "other",
        [
            Image.of_array(frame() + np.uint8(1)),
            Image.of_array(frame().astype(np.uint16)),
            Image.of_array(frame().reshape(60, 40)),
            Image(frame(np.float32), Grid((40, 60), (2.0, 1.0), (0.0, 0.0), ((1.0, 0.0), (0.0, 1.0)))),
        ],
        ids=["pixels", "type", "shape", "spacing"],
    )
    def test_changes_with_everything_that_matters(self, other):
        assert digest(other) != digest(Image.of_array(frame()))
