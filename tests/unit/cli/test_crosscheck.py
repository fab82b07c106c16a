"""``regframe crosscheck``, and the second engine by option."""

import json

import pytest

from regframe import METRICS
from regframe.peer.report import FILES

from .conftest import QUICK


@pytest.fixture
def check(pair, regframe):
    def command(*arguments):
        return regframe("crosscheck", "paper-similarity", *pair, *QUICK, *arguments)

    return command


def test_prints_a_table_a_floor_and_the_verdict(check):
    outcome = check()

    assert outcome.code == 0
    for words in ("components (", "pairs (", "whole run (", "metric along scale", "Both engines end"):
        assert words in outcome.out


def test_writes_a_page(check, tmp_path):
    outcome = check("--out", tmp_path / "out", "--quiet")

    assert outcome.code == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(FILES)
    assert len(outcome.out.splitlines()) == 2


def test_json_is_all_that_is_printed(check):
    outcome = check("--json")

    assert json.loads(outcome.out)["agrees"] is True
    assert outcome.err == ""


def test_a_bound_that_is_kept_passes(check):
    assert check("--quiet", "--fail-above", "0.001").code == 0


def test_a_bound_that_is_passed_fails(check, monkeypatch):
    monkeypatch.setattr("regframe.peer.report.Report.fails", lambda _, above: above == 0.25)

    assert check("--quiet", "--fail-above", "0.25").code == 1


def test_an_earlier_report_is_refused_before_the_work(check, tmp_path):
    (tmp_path / "crosscheck.json").write_text("mine")

    outcome = check("--out", tmp_path)

    assert outcome.code == 2
    assert "--force" in outcome.err or "overwrite" in outcome.err


def test_a_misspelt_preset_is_refused(pair, regframe):
    assert "Did you mean" in regframe("crosscheck", "paper-similarty", *pair).err


def test_registers_with_the_second_engine(pair, regframe):
    options = ("--preset", "paper-similarity", "--engine", "simpleitk", "--json")
    found = regframe("register", *pair, *QUICK, *options)

    assert json.loads(found.out)["provenance"]["engine"] == "simpleitk"


MINE = """
import numpy as np
from regframe import METRICS, Metric

@METRICS.register("my-difference")
class MyDifference(Metric):
    def value(self, pairs):
        return float(np.sum(pairs.weight * np.abs(pairs.fixed - pairs.moving)) / pairs.weight.sum())
"""


def test_a_script_with_a_metric_of_ones_own_is_checked_by_pairs(check, tmp_path):
    script = tmp_path / "mine.py"
    script.write_text(MINE)
    try:
        outcome = check("--plugin", script, "--set", "stages.0.metric=my-difference", "--json")
    finally:
        METRICS.forget("my-difference")

    found = json.loads(outcome.out)
    pairs = [line["verdict"] for line in found["lines"] if line["floor"] == "pairs"]
    assert outcome.code == 0
    assert found["agrees"] is True
    assert pairs == ["agrees", "agrees"]
    assert any("MyDifference" in line["why"] for line in found["lines"])


def test_a_missing_twin_is_explained_once(check):
    found = check("--set", "stages.0.metric=normalised-mi")

    assert found.out.count("SimpleITK has no twin of the metric normalised-mi.") == 1
    assert found.out.count("as above") == 3
