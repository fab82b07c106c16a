import numpy as np
import pytest
import SimpleITK as sitk

from regframe.io import read, write


@pytest.fixture
def shift(tmp_path):
    """A transform that takes fixed (x, y) to moving (x + 3, y + 2)."""
    sitk.WriteTransform(sitk.TranslationTransform(2, (3.0, 2.0)), str(tmp_path / "shift.tfm"))
    return tmp_path / "shift.tfm"


def test_writes_the_image_on_the_other_grid_at_its_own_depth(shift, pair, phantom, tmp_path, regframe):
    outcome = regframe("apply", shift, pair[1], "--like", pair[0], "--out", tmp_path / "aligned.png")

    aligned = read(tmp_path / "aligned.png").raw
    thermal = phantom.moving.raw
    assert outcome.code == 0
    assert aligned.dtype == np.uint16
    assert np.array_equal(aligned[:40, :60], thermal[2:42, 3:63])


def test_repeats_what_register_wrote(pair, tmp_path, regframe):
    out = tmp_path / "out"
    few = ("--preset", "paper-similarity", "--set", "stages.0.levels.0.iterations=4")
    regframe("register", *pair, *few, "--out", out, "--no-figures", "--no-verdict")

    regframe("apply", out / "transform.tfm", pair[1], "--like", pair[0], "--out", tmp_path / "again.png")

    assert np.array_equal(read(tmp_path / "again.png").raw, read(out / "aligned.png").raw)


def test_the_fill_is_what_lies_outside(shift, pair, tmp_path, regframe):
    regframe("apply", shift, pair[1], "--like", pair[0], "--out", tmp_path / "aligned.png", "--fill", 77)

    assert read(tmp_path / "aligned.png").raw[-1, -1] == 77


def test_the_interpolator_can_be_chosen(pair, tmp_path, regframe):
    half = tmp_path / "half.tfm"
    sitk.WriteTransform(sitk.TranslationTransform(2, (0.3, 0.0)), str(half))

    regframe("apply", half, pair[1], "--like", pair[1], "--out", tmp_path / "a.png", "-i", "nearest")

    assert np.array_equal(read(tmp_path / "a.png").raw, read(pair[1]).raw)


def test_does_not_overwrite(shift, pair, tmp_path, regframe):
    line = ("apply", shift, pair[1], "--like", pair[0], "--out", tmp_path / "aligned.png")
    regframe(*line)
    before = (tmp_path / "aligned.png").read_bytes()

    outcome = regframe(*line, "--fill", 9)

    assert outcome.code == 2
    assert "--force" in outcome.err
    assert (tmp_path / "aligned.png").read_bytes() == before
    assert regframe(*line, "--force").code == 0


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (1, "shfit.tfm", "Did you mean 'shift.tfm'?"),
        (2, "thermel.png", "Did you mean 'thermal.png'?"),
        (4, "visul.png", "Did you mean 'visual.png'?"),
        (6, "aligned.xyz", ".xyz"),
        (6, "missing/aligned.png", "missing"),
    ],
)
def test_wrong_files_are_named(place, value, said, shift, pair, tmp_path, regframe):
    line = ["apply", shift, pair[1], "--like", pair[0], "--out", tmp_path / "aligned.png"]
    line[place] = tmp_path / value

    outcome = regframe(*line)

    assert outcome.code == 2
    assert said in outcome.err


def test_a_misspelt_interpolator_is_named(shift, pair, tmp_path, regframe):
    outcome = regframe("apply", shift, pair[1], "--like", pair[0], "--out", tmp_path / "a.png", "-i", "liner")

    assert outcome.code == 2
    assert "Did you mean 'linear'?" in outcome.err


def test_an_image_is_no_transform(pair, tmp_path, regframe):
    outcome = regframe("apply", pair[0], pair[1], "--like", pair[0], "--out", tmp_path / "a.png")

    assert outcome.code == 2
    assert outcome.err.startswith("regframe: ")


def test_dimensions_must_agree(shift, pair, phantom, tmp_path, regframe):
    write(np.zeros((4, 5, 6), np.float32), phantom.fixed.grid.of_shape((4, 5, 6)), tmp_path / "volume.nii.gz")

    outcome = regframe(
        "apply", shift, tmp_path / "volume.nii.gz", "--like", pair[0], "--out", tmp_path / "a.png"
    )

    assert outcome.code == 2
    assert "3-D" in outcome.err
