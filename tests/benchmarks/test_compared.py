"""The comparison of metrics and the robustness benchmark run, and tell good from bad, on phantoms."""

import json

import numpy as np
import pytest
from benchmarks import cases, multimodal, robustness
from benchmarks.made import put

from regframe.catalog import METRICS

pytestmark = pytest.mark.slow


@pytest.fixture(autouse=True)
def phantoms(tmp_path, monkeypatch):
    monkeypatch.setattr(cases, "DATA", tmp_path)


def test_the_true_warp_of_a_case_is_true():
    """A case whose moving frame is the visual one too: mean squares has its optimum at the truth."""
    scene = cases.phantom(1)
    same = cases.Scene(scene.name, scene.visual, scene.visual)
    case = cases.drawn(same, multimodal.REACH, np.random.default_rng(1))

    found = multimodal.measure(METRICS.build("mean-squares"), [case])

    assert max(found.off) == 0.0
    assert found.ends[0.0][0] < 0.1


def test_a_metric_for_one_modality_is_worse_than_one_for_two():
    pairs = list(cases.each(multimodal.REACH, most=1))

    plain, edges = (
        multimodal.measure(METRICS.build(name), pairs)
        for name in ("mean-squares", "normalised-gradient-fields")
    )

    assert np.median(edges.off) < np.median(plain.off)


@pytest.mark.parametrize("name", robustness.FACTORS)
def test_the_largest_amount_makes_a_case(name):
    factor, scene = robustness.FACTORS[name], cases.phantom(1)

    case = factor.make(scene, factor.amounts[-1], np.random.default_rng(1))

    assert case.fixed.grid.shape == case.moving.grid.shape
    assert np.ptp(case.moving.values) > 50


def test_runs_are_kept_and_not_repeated(tmp_path, monkeypatch):
    monkeypatch.setattr(robustness, "outcome", lambda *_: (0.5, "good"))
    file = tmp_path / "results.json"

    first = robustness.run(["visual-thermal"], ["contrast"], cases.scenes(1), file)
    monkeypatch.setattr(robustness, "outcome", lambda *_: (float("inf"), "failed"))
    again = robustness.run(["visual-thermal"], ["contrast"], cases.scenes(1), file)

    assert again == first
    assert json.loads(file.read_text()) == {key: list(found) for key, found in first.items()}
    assert robustness.table(first, ["visual-thermal"], ["contrast"]).endswith("0: 100% · 1: 100% |")


def test_what_the_verdict_says_is_counted_apart_for_near_and_far_runs():
    outcomes = [(0.5, "good"), (4.9, "doubtful"), (0.7, "good"), (5.0, "failed"), (float("inf"), "failed")]
    results = {f"visual-thermal / shift / {i} / scene": outcome for i, outcome in enumerate(outcomes)}

    told = robustness.said(results, "visual-thermal")

    assert told.endswith("says of 3 runs within 5 px 2 good, 1 doubtful; of 2 others 2 failed.")


def test_measured_parts_are_put_between_their_marks(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- a: measured -->\nold\n<!-- a: end -->\nafter\n")

    put(page, "a", "new\n")
    put(page, "a", "newer\n")

    assert page.read_text() == "before\n<!-- a: measured -->\nnewer\n\n<!-- a: end -->\nafter\n"
