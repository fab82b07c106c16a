"""The options --moving-initial, --fixed-initial and --domain, and what is said of wrong ones."""

import json

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.geometry import Grid
from regframe.io import write
from regframe.transforms import files

from .conftest import QUICK

AFFINE = ("-p", "paper-similarity", *QUICK)


@pytest.fixture
def maps(tmp_path):
    """Transform files, and the grid of a smaller image."""
    singular = sitk.AffineTransform(2)
    singular.SetMatrix((1.0, 0.0, 1.0, 0.0))
    bending = sitk.BSplineTransformInitializer(sitk.Image([80, 60], sitk.sitkFloat32), [2, 2])
    known = {
        "beyond": sitk.TranslationTransform(2, (-3.0, 2.0)),
        "below": sitk.TranslationTransform(2, (4.0, 5.0)),
        "space": sitk.Euler3DTransform(),
        "singular": singular,
        "bending": bending,
    }
    for name, one in known.items():
        sitk.WriteTransform(one, str(tmp_path / f"{name}.tfm"))
    (tmp_path / "words.tfm").write_text("hello\n")
    grid = Grid.of_shape((30, 40))
    write(np.zeros(grid.shape, np.uint8), grid, tmp_path / "grid.png")
    volume = Grid((8, 8, 8), (1.0,) * 3, (0.0,) * 3, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    write(np.zeros(volume.shape, np.uint8), volume, tmp_path / "volume.nii.gz")
    return tmp_path


def test_all_three_together(pair, maps, regframe):
    outcome = regframe(
        *("register", *pair, *AFFINE, "--json", "--out", maps / "out", "--no-figures"),
        *("--moving-initial", maps / "beyond.tfm", "--fixed-initial", maps / "below.tfm"),
        *("--domain", maps / "grid.png"),
    )

    assert outcome.code == 0
    assert json.loads(outcome.out)["levels"][0]["samples"] == 30 * 40
    whole = files.read(maps / "out" / "transform.tfm", Grid.of_shape((60, 80)))
    kinds = [type(warp.transform).__name__ for warp in whole.warps]
    assert (kinds[0], len(kinds)) == ("Translation", 3)
    np.testing.assert_array_equal(whole.warps[0].params, [-3.0, 2.0])
    np.testing.assert_array_equal(whole.warps[-1].params, [-4.0, -5.0])


@pytest.mark.parametrize(
    ("option", "name", "told"),
    [
        ("--moving-initial", "beyond.tmf", "the moving-initial transform"),
        ("--fixed-initial", "below.tmf", "Did you mean 'below.tfm'?"),
        ("--domain", "grid.pgn", "the domain image"),
        ("--domain", ".", "is a folder"),
        ("--moving-initial", "space.tfm", "the transform is 3-D and the image 2-D"),
        ("--fixed-initial", "space.tfm", "the transform is 3-D and the image 2-D"),
        ("--domain", "volume.nii.gz", "the domain is 3-D"),
        ("--moving-initial", "words.tfm", "holds no transform"),
        ("--moving-initial", "grid.png", "no transform format"),
        ("--domain", "beyond.tfm", "no image format"),
        ("--fixed-initial", "bending.tfm", "bends"),
        ("--fixed-initial", "singular.tfm", "the fixed-initial map lays the image on a line"),
        ("--moving-initial", "singular.tfm", "the moving-initial map lays the image on a line"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(pair, maps, regframe, option, name, told):
    outcome = regframe("register", *pair, *AFFINE, option, maps / name, "--out", maps / "out")

    assert outcome.code == 2
    assert outcome.err.startswith("regframe: ")
    assert len(outcome.err.splitlines()) == 1
    assert told in outcome.err
    assert not (maps / "out").exists()
