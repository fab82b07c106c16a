import os
import stat

import numpy as np
import pytest

from regframe.errors import GeometryError, OutputError
from regframe.geometry import Grid
from regframe.io import atomic, read, refuse_existing, write

INTEGERS = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8"]
PLANE = Grid.of_shape((8, 11))
TILTED = Grid((8, 11), (0.5, 2.0), (3.0, -4.0), ((0.8, -0.6), (0.6, 0.8)))


def pixels(dtype, shape=(8, 11)):
    return (np.random.default_rng(1).random(shape) * 120).astype(dtype)


@pytest.mark.parametrize("suffix", [".png", ".bmp", ".tif", ".nrrd", ".mha", ".nii", ".nii.gz"])
@pytest.mark.parametrize("shape", [(8, 11), (8, 11, 3)])
def test_reads_back_what_it_writes(tmp_path, suffix, shape):
    write(pixels("u1", shape), PLANE, tmp_path / f"frame{suffix}")

    np.testing.assert_array_equal(read(tmp_path / f"frame{suffix}").raw, pixels("u1", shape))


@pytest.mark.parametrize("suffix", [".tiff", ".nrrd", ".mha", ".nii", ".nii.gz"])
@pytest.mark.parametrize("dtype", [*INTEGERS, "f4", "f8"])
def test_keeps_every_number_type(tmp_path, suffix, dtype):
    write(pixels(dtype), PLANE, tmp_path / f"frame{suffix}")

    raw = read(tmp_path / f"frame{suffix}").raw
    assert raw.dtype == dtype
    np.testing.assert_array_equal(raw, pixels(dtype))


@pytest.mark.parametrize("suffix", [".nrrd", ".mha", ".nii", ".nii.gz"])
def test_keeps_where_the_grid_lies(tmp_path, suffix):
    write(pixels("f4"), TILTED, tmp_path / f"slice{suffix}")

    # NIfTI keeps single precision.
    np.testing.assert_allclose(read(tmp_path / f"slice{suffix}").grid.corners(), TILTED.corners(), atol=1e-5)


def test_writes_a_volume_to_tiff_pages(tmp_path):
    write(pixels("u2", (3, 8, 11)), Grid.of_shape((3, 8, 11)), tmp_path / "stack.tif")

    np.testing.assert_array_equal(read(tmp_path / "stack.tif").raw, pixels("u2", (3, 8, 11)))


def test_writes_claims_as_black_and_white(tmp_path):
    claims = pixels("f4") > 60

    write(claims, PLANE, tmp_path / "mask.png")

    np.testing.assert_array_equal(read(tmp_path / "mask.png").raw, claims * np.uint8(255))


@pytest.mark.parametrize("dtype", [">u2", ">f8"])
def test_writes_numbers_of_the_other_byte_order(tmp_path, dtype):
    write(pixels(dtype), PLANE, tmp_path / "frame.tif")

    np.testing.assert_array_equal(read(tmp_path / "frame.tif").raw, pixels(dtype))


@pytest.mark.parametrize("suffix", [".PNG", ".Jpeg", ".BMP", ".TIF", ".NRRD", ".MHA", ".NII", ".NII.GZ"])
def test_knows_suffixes_in_capital_letters(tmp_path, suffix):
    write(np.full((8, 11), 7, np.uint8), PLANE, tmp_path / f"FRAME{suffix}")

    np.testing.assert_array_equal(read(tmp_path / f"FRAME{suffix}").raw, 7)


def test_writes_a_view(tmp_path):
    write(pixels("u1")[::-1, ::-1], PLANE, tmp_path / "frame.png")

    np.testing.assert_array_equal(read(tmp_path / "frame.png").raw, pixels("u1")[::-1, ::-1])


@pytest.mark.parametrize(
    ("suffix", "dtype"),
    [(".png", "f4"), (".png", "i2"), (".jpg", "u2"), (".bmp", "u2"), (".tif", "f2"), (".nrrd", "c8")],
)
def test_tells_a_type_that_the_format_cannot_hold(tmp_path, suffix, dtype):
    with pytest.raises(OutputError, match=rf"{suffix} cannot hold pixels of type {np.dtype(dtype)}.*Convert"):
        write(pixels(dtype), PLANE, tmp_path / f"frame{suffix}")


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".bmp"])
def test_tells_that_a_picture_is_no_volume(tmp_path, suffix):
    with pytest.raises(OutputError, match=r"cannot hold a volume .*\.nii\.gz"):
        write(pixels("u1", (3, 8, 11)), Grid.of_shape((3, 8, 11)), tmp_path / f"frame{suffix}")


def test_tells_that_jpeg_has_no_alpha(tmp_path):
    with pytest.raises(OutputError, match="cannot hold 4 channels"):
        write(pixels("u1", (8, 11, 4)), PLANE, tmp_path / "frame.jpg")


@pytest.mark.parametrize("shape", [(8, 12), (8,), (8, 11, 2), (8, 11, 3, 3)])
def test_tells_an_array_that_does_not_fit(tmp_path, shape):
    with pytest.raises(GeometryError, match="does not fit a grid"):
        write(pixels("u1", shape), PLANE, tmp_path / "frame.png")


def test_tells_colour_in_a_volume(tmp_path):
    with pytest.raises(GeometryError, match="in 2-D alone"):
        write(pixels("u1", (4, 8, 11, 3)), Grid.of_shape((4, 8, 11)), tmp_path / "volume.nrrd")


@pytest.mark.parametrize(
    ("name", "hint"), [("a.gif", r"Use \.png"), ("a", r"Use \.png"), ("a.mhd", r"write \.mha")]
)
def test_tells_an_unknown_suffix(tmp_path, name, hint):
    with pytest.raises(OutputError, match=rf"images are not written as .*{hint}"):
        write(pixels("u1"), PLANE, tmp_path / name)


def test_refuses_to_overwrite(tmp_path):
    write(pixels("u1"), PLANE, tmp_path / "frame.png")

    with pytest.raises(OutputError, match=r"exists already\. .*--force \(force=True\)"):
        write(pixels("u1") + 1, PLANE, tmp_path / "frame.png")

    np.testing.assert_array_equal(read(tmp_path / "frame.png").raw, pixels("u1"))


def test_overwrites_by_force(tmp_path):
    write(pixels("u1"), PLANE, tmp_path / "frame.png")

    write(pixels("u1") + 1, PLANE, tmp_path / "frame.png", force=True)

    np.testing.assert_array_equal(read(tmp_path / "frame.png").raw, pixels("u1") + 1)


def test_refuses_nothing_that_is_not_there(tmp_path):
    assert refuse_existing(tmp_path / "frame.png", force=False) is None


def test_tells_a_missing_folder(tmp_path):
    with pytest.raises(OutputError, match="its folder does not exist"):
        write(pixels("u1"), PLANE, tmp_path / "none" / "frame.png")


def test_tells_that_the_target_is_a_folder(tmp_path):
    with pytest.raises(OutputError, match="it is a folder"), atomic(tmp_path):
        pass


def test_tells_that_the_folder_is_a_file(tmp_path):
    (tmp_path / "file").touch()

    with pytest.raises(OutputError, match="its folder does not exist"):
        write(pixels("u1"), PLANE, tmp_path / "file" / "frame.png")


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root may write everywhere")
@pytest.mark.parametrize("suffix", [".png", ".nrrd", ".nii.gz"])
def test_tells_a_folder_without_permission(tmp_path, suffix):
    tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)

    with pytest.raises(OutputError, match="cannot write"):
        write(pixels("u1"), PLANE, tmp_path / f"frame{suffix}")


def test_tells_what_simpleitk_cannot_write_in_one_line(tmp_path, monkeypatch):
    def fail(*_):
        message = "Exception thrown in SimpleITK:\nITK ERROR: PNGImageIO(0x55d5): The disk is full.\n"
        raise RuntimeError(message)

    monkeypatch.setattr("SimpleITK.WriteImage", fail)

    with pytest.raises(OutputError, match=r"frame\.png': The disk is full\. Name another place\.$"):
        write(pixels("u1"), PLANE, tmp_path / "frame.png")

    assert list(tmp_path.iterdir()) == []


def test_tells_a_name_that_is_too_long(tmp_path):
    with pytest.raises(OutputError, match="File name too long"):
        write(pixels("u1"), PLANE, tmp_path / f"{'x' * 300}.png")

    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError, SystemExit])
def test_atomic_leaves_nothing_behind_on_failure(tmp_path, error):
    def fail():
        with atomic(tmp_path / "note.txt") as temporary:
            temporary.write_text("half")
            raise error

    with pytest.raises(error):
        fail()

    assert list(tmp_path.iterdir()) == []


def test_atomic_keeps_the_earlier_file_on_failure(tmp_path):
    (tmp_path / "note.txt").write_text("earlier")

    def stop():
        with atomic(tmp_path / "note.txt") as temporary:
            temporary.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        stop()

    assert (tmp_path / "note.txt").read_text() == "earlier"


def test_atomic_turns_faults_of_the_file_system_into_ours(tmp_path):
    def fill_up():
        with atomic(tmp_path / "note.txt"):
            raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="No space left on device"):
        fill_up()


def test_atomic_gives_a_name_that_ends_as_the_target_does(tmp_path):
    with atomic(tmp_path / "volume.nii.gz") as temporary:
        temporary.touch()

        assert temporary.parent == tmp_path
        assert temporary.name.endswith(".volume.nii.gz")


def test_a_written_file_has_the_permissions_of_any_other(tmp_path):
    (tmp_path / "plain").touch()

    write(pixels("u1"), PLANE, tmp_path / "frame.png")

    assert (tmp_path / "frame.png").stat().st_mode == (tmp_path / "plain").stat().st_mode
