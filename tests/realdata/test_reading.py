"""Every real file is read without a word, as the table of pairs describes it."""

import csv
import re

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import DATA

from regframe.geometry import Grid
from regframe.io import read


def table():
    if not (DATA / "pairs.csv").is_file():
        return []
    with (DATA / "pairs.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def listed():
    """Each file of the table once, with the size that the table gives for pictures, x first."""
    sizes = {row[role]: row[f"{role}_size"] for row in table() for role in ("fixed", "moving")}
    return sorted(sizes.items())


@pytest.mark.parametrize(("path", "size"), listed())
def test_reads_a_listed_file_in_silence(data, capfd, path, size):
    image = read(data / path)

    assert capfd.readouterr() == ("", "")
    assert not size or image.grid.shape == tuple(map(int, reversed(re.findall(r"\d+", size))))
    assert image.range()[0] < image.range()[1]
    if path.endswith((".png", ".jpg", ".tiff")):
        assert image.grid == Grid.of_shape(image.grid.shape)


@pytest.mark.parametrize("path", [path for path, _ in listed()])
def test_stores_what_simpleitk_reads(data, path):
    theirs = sitk.ReadImage(str(data / path))

    image = read(data / path)

    np.testing.assert_array_equal(image.raw, sitk.GetArrayFromImage(theirs))
    if not path.endswith((".png", ".jpg", ".tiff")):
        assert image.grid.spacing == theirs.GetSpacing()
        assert image.grid.origin == theirs.GetOrigin()
        assert np.ravel(image.grid.direction).tolist() == list(theirs.GetDirection())


def test_keeps_the_counts_of_a_16_bit_thermal_frame(data):
    cv2 = pytest.importorskip("cv2")
    path = data / "visual_thermal" / "caltech_aerial" / "thermal" / "thermal-25080.tiff"

    image = read(path)

    np.testing.assert_array_equal(image.values, cv2.imread(str(path), cv2.IMREAD_UNCHANGED))
    assert image.range() == (22308.0, 27268.0)


def test_reads_the_turned_slice_as_the_upright_one(data):
    folder = data / "multimodal_2d" / "itk_brain"
    upright = read(folder / "BrainT1SliceBorder20.png")
    turned = read(folder / "BrainT1SliceBorder20DirectionPlus30.mhd")

    np.testing.assert_array_equal(upright.values, turned.values)
    assert not turned.grid.upright
