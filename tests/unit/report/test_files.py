import csv
import dataclasses
import json

import numpy as np
import pytest

from regframe.engine.resampling import align
from regframe.errors import OutputError
from regframe.geometry import Grid
from regframe.interpolators.bspline import BSpline
from regframe.interpolators.nearest import Nearest
from regframe.io import read
from regframe.preset import load
from regframe.report import files
from regframe.transforms.files import read as read_transform
from support.results import image, ramp, result

EVERYTHING = sorted(("aligned.png", *files.DATA, *files.OVERLAYS, *files.PLOTS))


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_result_becomes_these_files(tmp_path):
    assert names(files.save(result(), tmp_path / "out")) == EVERYTHING


def test_folders_on_the_way_are_made(tmp_path):
    files.save(result(), tmp_path / "a" / "b", figures=False)

    assert (tmp_path / "a" / "b" / "result.json").is_file()


def test_without_figures_only_data_are_written(tmp_path):
    assert names(files.save(result(), tmp_path / "out", figures=False)) == sorted(
        ("aligned.png", *files.DATA)
    )


def test_the_result_saves_itself(tmp_path):
    assert names(result().save(tmp_path / "out", figures=False)) == sorted(("aligned.png", *files.DATA))


def test_json_and_csv_can_be_read_back(tmp_path):
    made = result()
    folder = files.save(made, tmp_path, figures=False)

    transform, outcome = (
        json.loads((folder / name).read_text()) for name in ("transform.json", "result.json")
    )
    with (folder / "trace.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))

    assert np.array_equal(transform["fixed_to_moving_px"], made.pixel_matrix)
    assert outcome["value"] == made.value
    assert [float(row["value"]) for row in rows] == [step.value for step in made.trace]


def test_the_transform_file_holds_the_warp(tmp_path):
    made = result()
    folder = files.save(made, tmp_path, figures=False)

    warp = read_transform(folder / "transform.tfm", made.fixed.grid)

    corners = made.fixed.grid.corners()
    assert np.allclose(warp(corners), made.warp(corners), atol=1e-12)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_the_aligned_image_keeps_its_depth(dtype, tmp_path):
    moving = image(ramp((12, 16), dtype), "thermal.png")

    folder = files.save(result(moving=moving, shift=(2, 0)), tmp_path, figures=False)

    aligned = read(folder / "aligned.png").raw
    assert aligned.dtype == dtype
    assert np.array_equal(aligned[:, :14], moving.raw[:, 2:])


def test_the_aligned_image_keeps_its_colour(tmp_path):
    colour = np.random.default_rng(1).integers(0, 256, (12, 16, 3), dtype=np.uint8)

    folder = files.save(result(moving=image(colour, "colour.jpg"), shift=(2, 0)), tmp_path, figures=False)

    assert np.array_equal(read(folder / "aligned.png").raw[:, :14], colour[:, 2:])


@pytest.mark.parametrize(
    ("interpolator", "way"),
    [("linear", BSpline(order=3)), ("bspline", BSpline(order=3)), ("nearest", Nearest())],
)
def test_the_aligned_image_is_splined_in_place_of_linear_and_else_as_the_preset_says(
    interpolator, way, tmp_path
):
    moving = image(ramp((12, 16)), "moving.mha")
    made = result(moving=moving, shift=(0.4, 0.3))
    preset = load(
        "paper-affine", {"stages.0.transform": "translation", "stages.0.interpolator": interpolator}
    )

    folder = files.save(dataclasses.replace(made, preset=preset), tmp_path, figures=False)

    expected = align(moving, made.fixed.grid, made.warp, way)
    assert np.array_equal(read(folder / "aligned.mha").raw, expected)


def test_the_aligned_image_lies_on_the_fixed_grid(tmp_path):
    fixed = image(ramp((12, 16), np.float32), "fixed.mha", spacing=(0.5, 0.5))

    folder = files.save(
        result(fixed, image(ramp((12, 16)), "moving.mha"), shift=(0, 0)), tmp_path, figures=False
    )

    assert read(folder / "aligned.mha").grid == fixed.grid


@pytest.mark.parametrize(
    ("name", "dtype", "shape", "spacing", "expected"),
    [
        ("thermal.png", np.uint16, (4, 5), None, "aligned.png"),
        ("thermal.JPG", np.uint8, (4, 5), None, "aligned.png"),
        ("thermal.TIFF", np.uint16, (4, 5), None, "aligned.tiff"),
        ("moving", np.float32, (4, 5), None, "aligned.tiff"),
        ("moving", np.bool_, (4, 5), None, "aligned.png"),
        ("moving", np.float64, (4, 5, 3), None, "aligned.nrrd"),
        ("head.nii.gz", np.int16, (4, 5, 6), (1.0, 1.0, 2.0), "aligned.nii.gz"),
        ("head.NII", np.int16, (4, 5, 6), (1.0, 1.0, 2.0), "aligned.nii"),
        ("head.mhd", np.int16, (4, 5, 6), (1.0, 1.0, 2.0), "aligned.nii.gz"),
        ("moving", np.float32, (4, 5, 6), None, "aligned.nii.gz"),
        ("slice.png", np.uint8, (4, 5), (1.0, 2.0), "aligned.mha"),
    ],
)
def test_the_aligned_image_takes_a_format_that_can_hold_it(name, dtype, shape, spacing, expected):
    moving = image(np.zeros(shape, dtype), name)
    grid = (
        moving.grid if spacing is None else Grid(shape, spacing, (0.0,) * len(shape), moving.grid.direction)
    )

    assert files.aligned_name(moving, grid) == expected


@pytest.mark.parametrize("dtype", [np.float16, np.bool_, np.int8, np.int64, np.float64])
def test_unusual_number_types_are_written_without_complaint(dtype, tmp_path):
    moving = image(ramp((12, 16), np.uint8).astype(dtype), "moving")

    folder = files.save(result(moving=moving, shift=(1, 0)), tmp_path, figures=False)

    assert list(folder.glob("aligned.*"))


def test_an_earlier_result_is_not_overwritten(tmp_path):
    files.save(result(), tmp_path, figures=False)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    with pytest.raises(OutputError, match=r"already holds 'aligned.png' and 4 more.*--force"):
        files.save(result(shift=(1, 1)), tmp_path)

    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_force_replaces_an_earlier_result_and_what_it_alone_had(tmp_path):
    files.save(result(), tmp_path)
    (tmp_path / "notes.txt").write_text("mine")

    files.save(
        result(moving=image(ramp((12, 16)), "m.tiff"), shift=(1, 1)), tmp_path, force=True, figures=False
    )

    assert names(tmp_path) == sorted(("aligned.tiff", "notes.txt", *files.DATA))


def test_files_of_others_do_not_stand_in_the_way(tmp_path):
    (tmp_path / "visual.png").write_bytes(b"")

    files.save(result(), tmp_path, figures=False)

    assert (tmp_path / "visual.png").read_bytes() == b""


def test_a_file_is_no_output_folder(tmp_path):
    (tmp_path / "out").write_text("")

    with pytest.raises(OutputError, match="is a file"):
        files.check(tmp_path / "out")


def test_a_file_on_the_way_is_no_folder(tmp_path):
    (tmp_path / "out").write_text("")

    with pytest.raises(OutputError, match="cannot be written"):
        files.check(tmp_path / "out" / "deeper")


def test_a_folder_without_permission_is_refused(tmp_path, monkeypatch):
    # Roots may write anywhere, so the system's answer is replaced.
    monkeypatch.setattr(files.os, "access", lambda *_: False)

    with pytest.raises(OutputError, match="no permission"):
        files.check(tmp_path / "new")


def test_checking_changes_nothing(tmp_path):
    files.check(tmp_path / "a" / "b")

    assert names(tmp_path) == []


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_an_interruption_leaves_nothing(error, tmp_path, monkeypatch):
    def interrupted(_):
        raise error

    monkeypatch.setattr(files, "overlays", interrupted)

    with pytest.raises(error):
        files.save(result(), tmp_path / "a" / "b")

    assert names(tmp_path) == []


def test_an_interruption_leaves_an_earlier_result_whole(tmp_path, monkeypatch):
    files.save(result(), tmp_path, figures=False)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def interrupted(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(files, "overlays", interrupted)
    with pytest.raises(KeyboardInterrupt):
        files.save(result(shift=(1, 1)), tmp_path, force=True)

    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_full_disk_is_told_in_words(tmp_path, monkeypatch):
    def full(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files, "overlays", full)

    with pytest.raises(OutputError, match="No space left on device"):
        files.save(result(), tmp_path / "out")
