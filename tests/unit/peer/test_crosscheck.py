"""The cross-check from preset and images to a report."""

import json
from html.parser import HTMLParser

import numpy as np
import pytest
from pydantic import Field

import regframe
from regframe import METRICS, Metric
from regframe.errors import OutputError
from regframe.peer.crosscheck import crosscheck
from regframe.peer.report import FILES, Line, Report, incomparable, largest, measured
from regframe.preset import load
from support import sitk as peer

STAGE = {
    "transform": "similarity",
    "interpolator": "linear",
    "metric": "mattes",
    "optimizer": {"type": "one-plus-one", "radius": 0.5},
    "levels": [{"shrink": 2, "smooth": 1.0, "iterations": 8}],
}
DESCENT = {"type": "regular-step-gradient-descent", "learning_rate": 0.5}


class CorrelationRatio(Metric):
    """A metric of a user's own, which SimpleITK has nothing like."""

    bins: int = Field(32, ge=4, description="Classes of fixed intensity.")

    def value(self, pairs):
        low, high = pairs.fixed_range
        label = np.clip((pairs.fixed - low) / (high - low) * self.bins, 0, self.bins - 1).astype(int)
        mass, first, second = (
            np.bincount(label, pairs.weight * pairs.moving**k, self.bins) for k in range(3)
        )
        within = second.sum() - (first**2 / np.maximum(mass, 1e-12)).sum()
        return float(within / (second.sum() - first.sum() ** 2 / mass.sum()))


@pytest.fixture(scope="module")
def pair():
    return peer.pair((30, 36))


@pytest.fixture(scope="module")
def report(pair):
    return crosscheck({"name": "small", "seed": 3, "stages": [STAGE]}, *pair)


def verdicts(report, floor):
    return {line.what: line.verdict for line in report.lines if line.floor == floor}


def test_everything_agrees(report):
    assert report.agrees
    assert report.corner < 1e-9
    assert {floor for floor in ("components", "pairs", "whole run") if verdicts(report, floor)} == {
        "components",
        "pairs",
        "whole run",
    }
    assert "not comparable" not in {line.verdict for line in report.lines}
    assert [sweep.name for sweep in report.sweeps] == ["scale", "angle_rad", "tx", "ty"]
    assert report.scores["native"]["simpleitk"] == pytest.approx(report.scores["native"]["native"])
    assert "simpleitk" in report.versions


@pytest.mark.parametrize("sampling", ["regular", "random"])
def test_sparse_samples_masks_and_two_stages_agree(pair, sampling):
    y, x = np.indices(pair[0].grid.shape)
    fixed, moving = pair[0].with_mask(x + y > 12), pair[1].with_mask(x < 33)
    level = {"iterations": 4, "sampling": sampling, "fraction": 0.5}
    first = {**STAGE, "transform": "translation", "levels": [level]}
    second = {**STAGE, "optimizer": DESCENT, "metric": "correlation", "levels": [level]}

    report = crosscheck({"stages": [first, second]}, fixed, moving)

    assert [line for line in report.lines if line.verdict != "agrees"] == []
    assert any(line.what.startswith("stage 2: ") for line in report.lines)


def test_what_is_said_otherwise_is_told(pair):
    report = crosscheck({"stages": [{**STAGE, "optimizer": DESCENT, "metric": "mean-squares"}]}, *pair)

    told = " ".join(report.notes)
    assert "physical-shift" in told
    assert "filtered" in told
    assert "as it is written" in told


def test_a_users_own_metric_is_checked_by_pairs(pair):
    METRICS.register("my-ratio")(CorrelationRatio)
    try:
        report = crosscheck({"stages": [{**STAGE, "metric": "my-ratio"}]}, *pair)
    finally:
        METRICS.forget("my-ratio")

    assert set(verdicts(report, "pairs").values()) == {"agrees"}
    assert verdicts(report, "components")["interpolated values"] == "agrees"
    assert verdicts(report, "components")["samples that count"] == "not comparable"
    assert set(verdicts(report, "whole run").values()) == {"not comparable"}
    assert report.agrees
    assert not report.fails(0.0)
    assert "no whole run" in report.verdict()
    assert any("CorrelationRatio" in line.why for line in report.lines)


@pytest.mark.parametrize("metric", ["oriented-gradients", "mind-ssc", "normalised-gradient-fields"])
def test_features_of_the_fixed_image_know_nothing_of_the_moving_ones_rim(metric, pair):
    # Frames of which a part alone meets: what is smoothed there shows at the rim.
    report = crosscheck({"stages": [{**STAGE, "metric": metric, "levels": [{"iterations": 8}]}]}, *pair)

    assert set(verdicts(report, "pairs").values()) == {"agrees"}


def test_a_report_of_a_users_own_metric_is_written_without_curves(pair, tmp_path):
    METRICS.register("my-ratio")(CorrelationRatio)
    try:
        report = crosscheck({"stages": [{**STAGE, "metric": "my-ratio"}]}, *pair)
        report.save(tmp_path / "out")
    finally:
        METRICS.forget("my-ratio")

    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(FILES)


def test_volumes_are_compared_in_millimetres():
    grid = regframe.Grid((12, 14, 16), (1.0, 1.1, 1.5), (3.0, 0.0, 0.0), tuple(map(tuple, np.eye(3))))
    pair = peer.pair((12, 14, 16), grid=grid)
    stage = {**STAGE, "transform": "translation", "levels": [{"iterations": 4}]}

    report = crosscheck({"stages": [stage]}, *pair)

    assert report.agrees
    assert report.unit == "mm"


class Links(HTMLParser):
    """Everything a page would load."""

    def __init__(self):
        HTMLParser.__init__(self)
        self.found = []

    def handle_starttag(self, tag, attrs):
        self.found += [value for name, value in attrs if name in ("src", "href")]


def test_files_are_whole_and_load_nothing(report, tmp_path):
    report.save(tmp_path / "out")

    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(FILES)
    record = json.loads((tmp_path / "out" / "crosscheck.json").read_text())
    assert record["agrees"] is True
    assert len(record["lines"]) == len(report.lines)
    page = (tmp_path / "out" / "crosscheck.html").read_text()
    links = Links()
    links.feed(page)
    assert links.found
    assert all(link.startswith("data:image/png;base64,") for link in links.found)
    assert report.verdict() in page


def test_an_earlier_report_is_kept(report, tmp_path):
    (tmp_path / FILES[0]).write_text("mine")

    with pytest.raises(OutputError):
        report.save(tmp_path)

    assert (tmp_path / FILES[0]).read_text() == "mine"


def test_a_page_can_be_drawn_without_runs():
    line = incomparable("whole run", "both engines", "no twin")

    drawn = Report(load("paper-similarity"), "a", "<b>", "px", (line,))

    from regframe.peer.page import html

    page = html(drawn, b"")
    assert "&lt;b&gt;" in page
    assert "no twin" in page


@pytest.mark.parametrize(
    ("difference", "said"),
    [
        (0.0, "agrees exactly"),
        (1e-12, "agrees to 1e-12 px"),
        (0.5, "differs by 0.5 px"),
        (float("inf"), "differs by inf px"),
        (float("nan"), "differs by nan px"),
    ],
)
def test_a_line_says_how_far(difference, said):
    assert measured("whole run", "corners", difference, 1e-6, "px").told() == said


def test_a_part_that_differs_fails_whatever_the_corners():
    differs = measured("components", "values", 1.0, 0.1, "px")
    agrees = Line("whole run", "corners", "agrees", 0.0, 1.0, "px")
    preset = load("paper-similarity")

    assert Report(preset, "a", "b", "px", (differs, agrees), corner=0.0).fails(1.0)
    assert Report(preset, "a", "b", "px", (agrees,), corner=2.0).fails(1.0)
    assert Report(preset, "a", "b", "px", (agrees,), corner=float("nan")).fails(1.0)
    assert not Report(preset, "a", "b", "px", (agrees,), corner=0.5).fails(1.0)


def test_the_largest_of_nothing_is_zero():
    assert largest([]) == 0.0
