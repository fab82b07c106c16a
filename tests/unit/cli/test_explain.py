import tomllib

import pytest

from regframe.catalog import KINDS
from regframe.cli.explain import example, options
from regframe.preset import names

EVERYTHING = [(kind, name) for kind, registry in KINDS.items() for name in registry.names()]


@pytest.mark.parametrize(("kind", "name"), EVERYTHING)
def test_every_component_is_explained(kind, name, regframe):
    outcome = regframe("explain", name)

    assert outcome.code == 0
    for option in KINDS[kind][name].model_fields:
        assert option in outcome.out
    assert "In a preset:" in outcome.out


@pytest.mark.parametrize(("kind", "name"), EVERYTHING)
def test_every_option_has_a_type_and_a_meaning(kind, name):
    for option, kind_of_value, default, _, meaning in options(KINDS[kind][name]):
        assert kind_of_value, option
        assert default, option
        assert meaning.endswith("."), option


@pytest.mark.parametrize(("kind", "name"), EVERYTHING)
def test_the_example_builds_the_component(kind, name):
    cls = KINDS[kind][name]
    line = example(kind, name, cls)
    if "= ..." in line:
        pytest.skip("has options without a default")

    tree = tomllib.loads(line)
    value = tree["filters"]["moving"][0] if kind == "filters" else next(iter(tree.values()))

    assert KINDS[kind].build(value) == cls()


def test_ranges_and_defaults_are_told(regframe):
    line = next(line for line in regframe("explain", "mattes").out.splitlines() if line.startswith("bins"))

    assert "50" in line
    assert ">=" in line


def test_parameters_of_transforms_are_named(regframe):
    assert "scale, angle_rad, tx, ty" in regframe("explain", "similarity").out


@pytest.mark.parametrize("name", names())
def test_presets_are_explained(name, regframe):
    outcome = regframe("explain", name)

    assert outcome.code == 0
    assert f"regframe preset show {name}" in outcome.out


def test_a_misspelt_name_is_told(regframe):
    outcome = regframe("explain", "matts")

    assert outcome.code == 2
    assert "Did you mean 'mattes'?" in outcome.err


def test_a_presets_levels_are_told_as_they_are_written(regframe):
    outcome = regframe("explain", "visual-thermal")

    assert (
        "25 at fit 142 by nelder-mead (carried), 12 at fit 250 (carried), 20 at fit 420 (carried)"
        in outcome.out
    )
