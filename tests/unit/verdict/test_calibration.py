"""The coefficients are those that the committed table gives, and they hold on scenes that were kept back."""

import csv
import json
import sys
from dataclasses import replace
from importlib import import_module
from importlib.resources import files

import numpy as np
import pytest

from house.source import REPOSITORY
from regframe.verdict import calibration
from regframe.verdict.evidence import Evidence

FOLDER = REPOSITORY / "docs" / "calibration"
MIDDLE = Evidence(
    round_trip_px=3.0,
    parts=10,
    parts_near=0.6,
    leftover_px=4.0,
    edge_fit=0.2,
    rival=0.8,
    sharpness=5.0,
    overlap=0.8,
)


@pytest.fixture(scope="module")
def fit():
    sys.path.insert(0, str(FOLDER))
    yield import_module("fit")
    sys.path.remove(str(FOLDER))


@pytest.fixture(scope="module")
def rows(fit):
    runs = import_module(fit.Row.__module__)
    with (FOLDER / "evidence.csv").open(encoding="utf-8", newline="") as file:
        return [runs.row_of(cells) for cells in list(csv.reader(file))[1:]]


def test_the_coefficients_are_those_of_the_table(fit, rows):
    written = json.loads(files("regframe.verdict").joinpath("coefficients.json").read_text(encoding="utf-8"))

    fitted = fit.everything(rows)

    assert written.keys() == fitted.keys()
    for kind, models in fitted.items():
        for model, numbers in models.items():
            assert written[kind][model] == pytest.approx(numbers, abs=0.02), (kind, model)


@pytest.mark.parametrize("second_search", [True, False])
def test_they_hold_on_scenes_that_were_kept_back(fit, rows, second_search):
    judged, chances = fit.kept_back((fit.searched if second_search else fit.unsearched)(rows))
    run = np.array([row.kind != "displaced" for row in judged])
    near, wrong = (np.array([claim(row) for row in judged]) for claim in (is_near, is_wrong))

    assert fit.auc(chances[run], near[run]) >= 0.99
    assert fit.calibration_error(chances[run], near[run]) <= 0.05
    assert (chances[wrong] >= calibration.GOOD).mean() <= 0.005
    assert (chances[near & run] < calibration.FAILED).mean() <= 0.02


def is_near(row):
    return row.near


def is_wrong(row):
    return row.kind == "wrong"


@pytest.mark.parametrize(
    "better",
    [
        {"round_trip_px": 1.5},
        {"parts_near": 0.8},
        {"leftover_px": 2.5},
        {"rival": 0.6},
        {"edge_fit": 0.3},
        {"parts": 12},
    ],
    ids=lambda change: next(iter(change)),
)
def test_better_evidence_never_lowers_the_probability(better):
    assert calibration.probability(replace(MIDDLE, **better)) >= calibration.probability(MIDDLE)
    assert calibration.expected_error_px(replace(MIDDLE, **better)) <= calibration.expected_error_px(MIDDLE)


def test_a_probability_is_between_nothing_and_certainty():
    for evidence in (MIDDLE, replace(MIDDLE, round_trip_px=None), replace(MIDDLE, rival=float("inf"))):
        assert 0.0 < calibration.probability(evidence) < 1.0


def test_no_kind_of_evidence_counts_without_bound():
    bounded = replace(MIDDLE, round_trip_px=1e9, leftover_px=float("inf"), rival=1e9)

    assert np.isfinite(calibration.features(bounded)).all()
    assert np.array_equal(calibration.features(bounded), calibration.features(replace(bounded, rival=1e12)))
