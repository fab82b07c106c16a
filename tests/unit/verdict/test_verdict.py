import json
import pickle
from dataclasses import replace

import numpy as np
import pytest

from regframe.engine.run import register
from regframe.image import Image
from regframe.preset import load
from regframe.testing.phantoms import visual_thermal
from regframe.verdict import verdict as module
from regframe.verdict.evidence import Evidence
from regframe.verdict.verdict import Verdict, judge, reasons, word
from support.results import image, ramp, result

RIGHT = Evidence(
    round_trip_px=0.3,
    parts=12,
    parts_near=0.95,
    leftover_px=0.8,
    edge_fit=0.35,
    rival=0.4,
    sharpness=9.0,
    overlap=0.9,
)
WRONG = Evidence(
    round_trip_px=140.0,
    parts=7,
    parts_near=0.1,
    leftover_px=15.0,
    edge_fit=0.06,
    rival=1.3,
    sharpness=2.0,
    overlap=0.6,
)


def given(found, monkeypatch):
    """A judge that is handed its evidence."""
    monkeypatch.setattr(module.calibration, "excuse", lambda _: "")
    monkeypatch.setattr(module, "evidence", lambda *_, **__: found)
    return judge(result())


def test_good_evidence_is_called_good(monkeypatch):
    verdict = given(RIGHT, monkeypatch)

    assert verdict == "good"
    assert verdict.probability > 0.95
    assert 0.3 < verdict.expected_error_px < 3.0


def test_bad_evidence_is_called_failed(monkeypatch):
    verdict = given(WRONG, monkeypatch)

    assert verdict == "failed"
    assert verdict.probability < 0.05
    assert verdict.expected_error_px > 10.0


def test_contradicting_evidence_is_neither(monkeypatch):
    """All looks well, but the images fit as well elsewhere, and the way back ended there."""
    verdict = given(
        replace(RIGHT, round_trip_px=60.0, rival=0.98, parts_near=0.6, leftover_px=4.0), monkeypatch
    )

    assert verdict != "good"


def test_evidence_that_is_infinite_or_missing_can_be_judged(monkeypatch):
    nothing = Evidence(float("inf"), 0, 0.0, float("inf"), 0.0, float("inf"), 0.0, 0.0)

    assert given(nothing, monkeypatch) == "failed"
    assert given(replace(nothing, round_trip_px=None), monkeypatch) == "failed"


@pytest.mark.parametrize(
    ("probability", "said"),
    [(0.95, "good"), (0.9, "good"), (0.5, "doubtful"), (0.2, "doubtful"), (0.1, "failed")],
)
def test_the_word_follows_the_probability(probability, said):
    assert word(probability) == said


def test_a_verdict_is_its_word():
    verdict = Verdict("good", probability=0.98, expected_error_px=1.25, evidence=RIGHT)

    assert verdict == "good"
    assert f"{verdict}" == "good"
    assert json.dumps({"verdict": verdict}) == '{"verdict": "good"}'
    assert repr(verdict) == "Verdict('good', probability=0.98, expected_error_px=1.25)"


def test_a_verdict_survives_pickle():
    verdict = pickle.loads(pickle.dumps(Verdict("good", probability=0.98, evidence=RIGHT, reasons=("so",))))

    assert (verdict, verdict.probability, verdict.evidence, verdict.reasons) == ("good", 0.98, RIGHT, ("so",))


@pytest.mark.parametrize(
    ("verdict", "said"),
    [
        (
            Verdict("good", probability=0.9999, expected_error_px=1.24),
            "good: within 5 px with a probability of 99 %, expected error 1.2 px",
        ),
        (
            Verdict("failed", probability=0.0, expected_error_px=80.0),
            "failed: within 5 px with a probability of 1 %",
        ),
        (
            Verdict("unjudged", reasons=("no runs on volumes were calibrated",)),
            "unjudged: no runs on volumes",
        ),
    ],
)
def test_the_summary_never_claims_certainty(verdict, said):
    assert verdict.summary().startswith(said)


def test_the_reasons_are_told_in_words():
    said = " ".join(reasons(RIGHT))

    assert "confirms the map: 0.3 px apart" in said
    assert "12 parts of the image have 95 % of their edges within 5 px" in said
    assert "at most 40 % as well" in said
    assert "90 % of the smaller field of view" in said


def test_the_reasons_against_are_told_in_words():
    said = " ".join(reasons(WRONG))

    assert "contradicts the map: 140.0 px apart" in said
    assert "1.3 times as well with the moving image shifted elsewhere" in said


def test_missing_evidence_is_told_or_left_out():
    nothing = Evidence(None, 0, 0.0, float("inf"), 0.0, float("inf"), 0.0, 0.0)

    said = " ".join(reasons(nothing))

    assert "second search" not in said
    assert "No part of the image" in said
    assert "no more than by chance" in said
    assert "found nothing" in " ".join(reasons(replace(nothing, round_trip_px=float("inf"))))


def test_volumes_are_not_judged():
    volume = image(ramp((6, 8, 10)), "volume.nii")

    verdict = result(volume, volume, shift=(0, 0, 0)).verdict

    assert verdict == "unjudged"
    assert verdict.evidence is None
    assert "volumes" in verdict.summary()


@pytest.mark.parametrize(
    ("shape", "spacing", "metric", "why"),
    [
        ((100, 120), (0.5, 0.5), "mattes", "camera frames"),
        ((100, 120), None, "mean-squares", "metric mean-squares"),
        ((40, 120), None, "mattes", "less than 96 pixels"),
    ],
)
def test_what_was_not_calibrated_is_not_judged_but_looked_at(shape, spacing, metric, why):
    one = image(np.random.default_rng(1).integers(0, 255, shape, np.uint8), "one.png", spacing=spacing)
    preset = load("paper-similarity", {"stages.0.metric": metric})

    verdict = replace(result(one, one, shift=(0, 0)), preset=preset).verdict

    assert verdict == "unjudged"
    assert why in verdict.summary()
    assert verdict.probability is None
    assert verdict.evidence.round_trip_px is None
    assert verdict.evidence.edge_fit > 0.9


def test_a_result_is_judged_once_and_when_asked(monkeypatch):
    asked = []
    monkeypatch.setattr(module, "judge", lambda one: asked.append(one) or Verdict("good"))
    made = result()

    before = len(asked)
    first, second = made.verdict, made.verdict

    assert before == 0
    assert first is second
    assert asked == [made]


@pytest.mark.slow
@pytest.mark.parametrize("preset", ["visual-thermal", "paper-similarity"])
def test_a_street_is_judged_as_it_is(preset):
    """Streets of other seeds share kerbs and horizon, and so the map; one upside down shares nothing."""
    street = visual_thermal(3, (160, 200))
    upside_down = Image.of_array(np.rot90(street.moving.raw, 2))

    good, failed = (register(preset, street.fixed, moving).verdict for moving in (street.moving, upside_down))

    assert good == "good"
    assert failed == "failed"
