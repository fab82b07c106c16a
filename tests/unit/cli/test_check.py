import json

import pytest
from conformance import planted

from regframe.catalog import METRICS


@pytest.fixture
def wrong():
    """A registered metric whose slope points downhill."""
    METRICS.register("wrong-sign")(planted.WrongSign)
    yield "wrong-sign"
    METRICS.forget("wrong-sign")


def test_a_good_metric_gets_a_verdict_a_claim(regframe):
    outcome = regframe("check", "metric", "mean-squares")

    assert outcome.code == 0
    assert "holds           derivative matches differences" in outcome.out
    assert "does not apply  holds its invariances" in outcome.out
    assert "0 fail" in outcome.out
    assert "times mean-squares" in outcome.out


def test_a_fault_is_named_and_the_exit_code_tells(wrong, regframe):
    outcome = regframe("check", "metric", wrong)

    assert outcome.code == 1
    assert "FAILS           derivative matches differences" in outcome.out
    assert "`derivative` is not the slope of `value`" in outcome.out
    assert "1 fail," in outcome.out.replace("fails", "fail")


def test_json_holds_every_verdict(wrong, regframe):
    outcome = regframe("check", "metric", wrong, "--json")

    record = json.loads(outcome.out)
    failed = [verdict["name"] for verdict in record["verdicts"] if verdict["outcome"] == "fails"]
    assert outcome.code == 1
    assert record["passed"] is False
    assert record["component"] == {"type": "wrong-sign", "power": 2.0}
    assert failed == ["derivative matches differences"]
    assert record["cost"]["ratio"] > 0


def test_options_are_set(regframe):
    outcome = regframe("check", "filter", "window", "--set", "low=20", "--set", "high=80")

    assert outcome.code == 0
    assert "Cost" not in outcome.out


def test_a_missing_option_is_told(regframe):
    outcome = regframe("check", "filter", "window")

    assert outcome.code == 2
    assert "low: is required and missing. Write low" in outcome.err


def test_the_plural_works_too(regframe):
    assert regframe("check", "filters", "invert").code == 0


def test_an_unknown_name_is_answered_with_the_nearest(regframe):
    outcome = regframe("check", "metric", "mates")

    assert outcome.code == 2
    assert "Did you mean 'mattes'?" in outcome.err
