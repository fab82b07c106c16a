"""The paper's presets through the command line, on real frames of equal and of unequal size."""

import csv
import json

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.cli.main import run
from regframe.io import read

PRESETS = ["paper-similarity", "paper-affine", "paper-similarity-pyramid", "paper-affine-pyramid"]
PICTURES = {
    "overlay-red-cyan.png",
    "overlay-difference.png",
    "overlay-checkerboard.png",
    "overlay-before.png",
    "histograms.png",
    "joint-histogram.png",
    "convergence.png",
}
RECORDS = {"aligned.png", "transform.tfm", "transform.json", "result.json", "trace.csv"}


def check(folder, visual, thermal, preset):
    assert {path.name for path in folder.iterdir()} == PICTURES | RECORDS
    aligned, moving = read(folder / "aligned.png"), read(thermal)
    assert aligned.grid.shape == read(visual).grid.shape
    assert aligned.raw.dtype == moving.raw.dtype
    assert json.loads((folder / "result.json").read_text())["preset"]["name"] == preset
    matrix = np.array(json.loads((folder / "transform.json").read_text())["fixed_to_moving_px"])
    written = sitk.ReadTransform(str(folder / "transform.tfm"))
    for point in ((0.0, 0.0), (100.0, 50.0)):
        expected = matrix @ [*point, 1.0]
        np.testing.assert_allclose(written.TransformPoint(point), expected[:2], atol=1e-9)
    with (folder / "trace.csv").open() as lines:
        assert len(list(csv.DictReader(lines))) >= 300


@pytest.mark.parametrize("preset", PRESETS)
def test_frames_of_one_size(data, tmp_path, preset):
    folder = data / "visual_thermal" / "roadscene"
    pair = [str(folder / kind / "FLIR_06795.jpg") for kind in ("visual", "thermal")]

    code = run(["register", *pair, "--preset", preset, "--out", str(tmp_path / "out"), "--quiet"])

    assert code == 0
    check(tmp_path / "out", *pair, preset)


@pytest.mark.slow
@pytest.mark.parametrize("preset", PRESETS)
def test_frames_of_unequal_size(data, tmp_path, preset):
    folder = data / "visual_thermal" / "roadscene_raw"
    pair = [str(folder / "visual" / "FLIR_07209.jpg"), str(folder / "thermal" / "FLIR_07209.png")]

    # Mutual information alone loses this pair, as the verdict says; the files are wanted anyway.
    options = ["--preset", preset, "--out", str(tmp_path / "out"), "--quiet", "--keep-failed"]
    code = run(["register", *pair, *options])

    assert code == 0
    check(tmp_path / "out", *pair, preset)


def test_frames_of_unequal_depth(data, tmp_path):
    folder = data / "visual_thermal" / "caltech_aerial"
    pair = [str(folder / "visual" / "mono-12540.jpg"), str(folder / "thermal" / "thermal-25080.tiff")]
    few = ["--preset", "paper-similarity"]
    few += ["--set", "stages.0.levels=[{shrink = 4, smooth = 2.0, iterations = 20}]", "--no-verdict"]

    code = run(["register", *pair, "--out", str(tmp_path / "out"), "--no-figures", "--quiet", *few])

    aligned = read(tmp_path / "out" / "aligned.tiff")
    assert code == 0
    assert aligned.raw.dtype == np.uint16
    assert aligned.values.max() > 255
