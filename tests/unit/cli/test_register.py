import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from regframe.cli import register as command
from regframe.io import read, write
from regframe.report import files
from regframe.verdict.evidence import Evidence
from regframe.verdict.verdict import Verdict

from .conftest import QUICK


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_writes_everything_and_says_where(pair, tmp_path, regframe):
    outcome = regframe("register", *pair, *QUICK, "--out", tmp_path / "out")

    assert outcome.code == 0
    assert names(tmp_path / "out") == sorted(("aligned.png", *files.DATA, *files.OVERLAYS, *files.PLOTS))
    assert str(tmp_path / "out") in outcome.out
    assert "overlay-red-cyan.png" in outcome.out


def test_the_aligned_frame_has_the_visual_grid_and_the_thermal_depth(pair, tmp_path, regframe):
    regframe("register", *pair, *QUICK, "--out", tmp_path / "out", "--no-figures")

    aligned = read(tmp_path / "out" / "aligned.png").raw
    assert aligned.shape == (60, 80)
    assert aligned.dtype == np.uint16


def test_without_a_folder_nothing_is_written(pair, tmp_path, regframe):
    outcome = regframe("register", *pair, *QUICK)

    assert outcome.code == 0
    assert "--out" in outcome.out
    assert names(tmp_path) == ["thermal.png", "visual.png"]


def test_progress_goes_to_the_error_stream_a_line_a_level(pair, regframe):
    outcome = regframe(
        "register", *pair, "-p", "paper-similarity-pyramid", "--set", "stages.0.levels.2.iterations=2"
    )

    assert [line.partition(" (")[0] for line in outcome.err.splitlines()] == [
        "level 1/3",
        "level 2/3",
        "level 3/3",
    ]


def test_quiet_prints_one_line(pair, tmp_path, regframe):
    outcome = regframe("register", *pair, *QUICK, "--out", tmp_path / "out", "--quiet", "--no-figures")

    assert outcome.err == ""
    assert outcome.out.count("\n") == 1
    assert "scale" in outcome.out


def test_json_is_all_that_is_printed(pair, regframe):
    outcome = regframe("register", *pair, *QUICK, "--json")

    record = json.loads(outcome.out)
    assert outcome.err == ""
    assert record["preset"]["stages"][0]["levels"][0]["iterations"] == 4
    assert np.shape(record["transform"]["fixed_to_moving_px"]) == (3, 3)


def test_the_seed_is_the_presets(pair, regframe):
    record = json.loads(regframe("register", *pair, *QUICK, "--seed", 7, "--json").out)

    assert record["preset"]["seed"] == 7


def test_settings_change_the_preset(pair, regframe):
    outcome = regframe("register", *pair, *QUICK, "--set", "stages.0.transform=affine", "--json")

    assert json.loads(outcome.out)["preset"]["stages"][0]["transform"] == {"type": "affine"}


def test_threads_are_told_to_the_kernels(pair, regframe):
    record = json.loads(regframe("register", *pair, *QUICK, "--threads", 2, "--json").out)

    assert record["provenance"]["threads"] == 2


def test_a_run_can_begin_where_another_ended(pair, tmp_path, regframe):
    first = json.loads(
        regframe("register", *pair, *QUICK, "--out", tmp_path / "out", "--json", "--no-figures").out
    )

    second = regframe("register", *pair, *QUICK, "--start", tmp_path / "out" / "transform.tfm", "--json")

    assert json.loads(second.out)["levels"][0]["start_value"] == pytest.approx(first["value"], rel=1e-6)


def test_masks_change_the_result(pair, phantom, tmp_path, regframe):
    half = np.zeros(phantom.fixed.grid.shape, np.uint8)
    half[:, :40] = 255
    write(half, phantom.fixed.grid, tmp_path / "mask.png")

    whole, masked = (
        json.loads(regframe("register", *pair, *QUICK, *more, "--json").out)["value"]
        for more in ((), ("--fixed-mask", tmp_path / "mask.png"))
    )

    assert whole != masked


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("--preset", "paper-similarty"), "Did you mean 'paper-similarity'?"),
        (("--preset", "missing.toml"), "missing.toml"),
        (("-p", "paper-similarity", "--set", "stages.0.metric.bin=32"), "Did you mean 'bins'?"),
        (("--set", "seed"), "path=value"),
        (("--seed", "-1"), "seed"),
        (("--engine", "nativ"), "Did you mean 'native'?"),
        (("--start", "nowhere.tfm"), "nowhere.tfm"),
        (("--fixed-mask", "nowhere.png"), "nowhere.png"),
    ],
)
def test_bad_options_are_refused(change, said, pair, regframe):
    outcome = regframe("register", *pair, *change)

    assert outcome.code == 2
    assert said in outcome.err
    assert outcome.err.startswith("regframe: ")


def test_a_missing_file_is_named_with_its_neighbour(pair, tmp_path, regframe):
    outcome = regframe("register", pair[0], tmp_path / "termal.png")

    assert outcome.code == 2
    assert "moving image" in outcome.err
    assert "Did you mean 'thermal.png'?" in outcome.err


def test_a_missing_folder_is_named_with_its_neighbour(pair, tmp_path, regframe):
    (tmp_path / "frames").mkdir()

    outcome = regframe("register", pair[0], tmp_path / "frame" / "thermal.png")

    assert "Did you mean 'frames'?" in outcome.err


def test_a_folder_is_no_image(pair, tmp_path, regframe):
    assert "is a folder" in regframe("register", pair[0], tmp_path).err


def test_a_file_that_is_no_image_is_refused(pair, tmp_path, regframe):
    (tmp_path / "notes.png").write_text("hello")

    outcome = regframe("register", pair[0], tmp_path / "notes.png")

    assert outcome.code == 2
    assert "notes.png" in outcome.err


def test_constant_images_are_refused(pair, phantom, tmp_path, regframe):
    write(np.full((20, 30), 7, np.uint8), phantom.fixed.grid.of_shape((20, 30)), tmp_path / "flat.png")

    outcome = regframe("register", pair[0], tmp_path / "flat.png")

    assert outcome.code == 2
    assert "constant" in outcome.err


def test_no_overlap_is_a_failed_registration(pair, tmp_path, regframe):
    far = (
        "#Insight Transform File V1.0\n#Transform 0\nTransform: TranslationTransform_double_2_2\n"
        "Parameters: 5000 5000\nFixedParameters:\n"
    )
    (tmp_path / "far.tfm").write_text(far)

    outcome = regframe("register", *pair, *QUICK, "--start", tmp_path / "far.tfm", "--out", tmp_path / "out")

    assert outcome.code == 1
    assert outcome.err.startswith("regframe: ")
    assert not (tmp_path / "out").exists()


def test_an_earlier_result_is_refused_before_the_work(pair, tmp_path, regframe, monkeypatch):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "result.json").write_text("mine")
    monkeypatch.setattr(command, "resolve", lambda *_: pytest.fail("the work began"))

    outcome = regframe("register", *pair, "--out", tmp_path / "out")

    assert outcome.code == 2
    assert "--force" in outcome.err
    assert (tmp_path / "out" / "result.json").read_text() == "mine"


def test_force_replaces_an_earlier_result(pair, tmp_path, regframe):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "result.json").write_text("mine")

    outcome = regframe("register", *pair, *QUICK, "--out", tmp_path / "out", "--force", "--no-figures")

    assert outcome.code == 0
    assert json.loads((tmp_path / "out" / "result.json").read_text())["stop"]


def test_an_interruption_while_writing_leaves_nothing(pair, tmp_path, regframe, monkeypatch):
    def interrupted(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(files, "overlays", interrupted)

    outcome = regframe("register", *pair, *QUICK, "--out", tmp_path / "out")

    assert outcome.code == 130
    assert outcome.err.splitlines()[-1].startswith("regframe: interrupted")
    assert names(tmp_path) == ["thermal.png", "visual.png"]


@pytest.mark.skipif(os.name == "nt", reason="sends a signal of POSIX")
def test_control_c_stops_a_run_in_one_line(pair, tmp_path):
    line = ["-m", "regframe", "register", *map(str, pair), "--out", str(tmp_path / "out")]
    levels = "[{shrink = 4, iterations = 1}, {iterations = 1000000}]"
    options = [
        "-p",
        "paper-similarity",
        "--set",
        f"stages.0.levels={levels}",
        "--set",
        "stages.0.optimizer.epsilon=0",
    ]
    with subprocess.Popen([sys.executable, *line, *options], stderr=subprocess.PIPE, text=True) as process:
        # The first level's line says that the run goes.
        assert process.stderr is not None
        assert process.stderr.readline().startswith("level 1/2")
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()

    assert process.returncode == 130
    assert rest == "regframe: interrupted; no file is left half-written.\n"
    assert names(tmp_path) == ["thermal.png", "visual.png"]


@pytest.fixture
def judged(monkeypatch):
    """Every result is judged by this word."""

    def as_(said):
        found = Evidence(140.0, 7, 0.1, 15.0, 0.06, 1.3, 2.0, 0.6)
        verdict = Verdict(
            said, probability=0.02, expected_error_px=60.0, evidence=found, reasons=("It is so.",)
        )
        monkeypatch.setattr("regframe.verdict.verdict.judge", lambda _: verdict)

    return as_


def test_the_verdict_is_told_with_its_reasons(pair, tmp_path, regframe, judged):
    judged("doubtful")

    outcome = regframe("register", *pair, *QUICK, "--out", tmp_path / "out", "--no-figures")

    assert outcome.code == 0
    assert "doubtful: within 5 px with a probability of 2 %, expected error 60.0 px" in outcome.out
    assert "It is so." in outcome.out
    assert json.loads((tmp_path / "out" / "result.json").read_text())["verdict"]["verdict"] == "doubtful"
    assert (tmp_path / "out" / "transform.tfm").is_file()


def test_a_failed_registration_withholds_what_scripts_pick_up(pair, tmp_path, regframe, judged):
    judged("failed")

    outcome = regframe("register", *pair, *QUICK, "--out", tmp_path / "out")

    assert outcome.code == 1
    assert names(tmp_path / "out") == sorted(("result.json", "trace.csv", *files.OVERLAYS, *files.PLOTS))
    assert "--keep-failed" in outcome.out


def test_a_failed_registration_replaces_the_map_of_an_earlier_one(pair, tmp_path, regframe, judged):
    judged("good")
    regframe("register", *pair, *QUICK, "--out", tmp_path / "out", "--no-figures")
    judged("failed")

    outcome = regframe("register", *pair, *QUICK, "--out", tmp_path / "out", "--no-figures", "--force")

    assert outcome.code == 1
    assert names(tmp_path / "out") == ["result.json", "trace.csv"]


def test_a_failed_registration_can_be_kept(pair, tmp_path, regframe, judged):
    judged("failed")

    outcome = regframe("register", *pair, *QUICK, "--out", tmp_path / "out", "--keep-failed", "--no-figures")

    assert outcome.code == 0
    assert "failed" in outcome.out
    assert names(tmp_path / "out") == sorted(("aligned.png", *files.DATA))


def test_a_failed_registration_has_no_transform_in_json(pair, regframe, judged):
    judged("failed")

    outcome = regframe("register", *pair, *QUICK, "--json")

    record = json.loads(outcome.out)
    assert outcome.code == 1
    assert record["verdict"]["verdict"] == "failed"
    assert record["transform"] is None


def test_quiet_begins_with_the_verdict(pair, regframe, judged):
    judged("good")

    assert regframe("register", *pair, *QUICK, "--quiet").out.startswith("good; ")


def test_without_a_verdict_none_is_made(pair, tmp_path, regframe, monkeypatch):
    monkeypatch.setattr("regframe.verdict.verdict.judge", lambda _: pytest.fail("it was judged"))

    outcome = regframe("register", *pair, *QUICK, "--no-verdict", "--out", tmp_path / "out", "--no-figures")

    assert outcome.code == 0
    assert "\nverdict" not in outcome.out
    assert json.loads((tmp_path / "out" / "result.json").read_text())["verdict"] is None
    assert (tmp_path / "out" / "transform.tfm").is_file()


def test_what_is_not_calibrated_is_not_judged(pair, regframe):
    outcome = regframe("register", *pair, *QUICK)

    assert outcome.code == 0
    assert "unjudged: no frames of less than 96 pixels were calibrated, and one here has 48" in outcome.out
