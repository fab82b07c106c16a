import json
import tomllib

from regframe.preset import load, parse


def test_show_prints_what_loads_again(regframe):
    outcome = regframe("preset", "show", "paper-affine")

    assert parse(tomllib.loads(outcome.out)) == load("paper-affine")


def test_show_takes_changes(regframe):
    outcome = regframe("preset", "show", "paper-affine", "--set", "seed=9")

    assert tomllib.loads(outcome.out)["seed"] == 9


def test_validate_says_what_is_good(regframe):
    outcome = regframe("preset", "validate", "paper-similarity-pyramid")

    assert outcome.code == 0
    assert outcome.out == "paper-similarity-pyramid is valid: 1 stage, 3 levels.\n"


def test_validate_tells_every_fault_with_its_path(tmp_path, regframe):
    text = (
        'extends = "paper-similarity"\n"stages.0.transform" = "similarty"\n"stages.0.metric.bins" = "many"\n'
    )
    (tmp_path / "mine.toml").write_text(text)

    outcome = regframe("preset", "validate", tmp_path / "mine.toml")

    assert outcome.code == 2
    assert "stages.0.transform" in outcome.err
    assert "Did you mean 'similarity'?" in outcome.err
    assert "stages.0.metric.bins" in outcome.err


def test_schema_is_json(regframe):
    assert json.loads(regframe("preset", "schema").out)["properties"]["stages"]


def test_diff_lists_paths(regframe):
    outcome = regframe("preset", "diff", "paper-similarity", "paper-affine")

    assert any(
        line.split()[:1] == ["stages.0.transform"] and "similarity" in line and "affine" in line
        for line in outcome.out.splitlines()
    )


def test_diff_of_equals_says_so(regframe):
    assert regframe("preset", "diff", "paper-affine", "paper-affine").out == "no difference\n"
