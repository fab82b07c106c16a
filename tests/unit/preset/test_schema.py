import json
import tomllib

import pytest

from regframe.catalog import KINDS
from regframe.preset import dump, folder, names, schema
from support.json_schema import valid


def references(node: object) -> set[str]:
    """Every definition that a schema refers to."""
    if isinstance(node, list):
        return set().union(*map(references, node))
    if isinstance(node, dict):
        own = {node["$ref"]} if "$ref" in node else set()
        return own.union(*map(references, node.values()))
    return set()


@pytest.fixture
def whole() -> dict:
    return schema()


def test_is_json(whole):
    assert json.loads(json.dumps(whole)) == whole


def test_every_reference_leads_somewhere(whole):
    assert references(whole) <= {f"#/$defs/{name}" for name in whole["$defs"]}


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_names_every_component_that_can_be_imported(whole, kind):
    registry = KINDS[kind]
    usable = [name for name in registry.names() if not broken(kind, name)]

    assert whole["$defs"][registry.kind]["anyOf"][0] == {"enum": usable}


def broken(kind: str, name: str) -> bool:
    """Whether a component cannot be imported."""
    try:
        KINDS[kind][name]
    except Exception:
        return True
    return False


def test_holds_the_options_of_a_component_of_this_session(whole):
    bins = whole["$defs"]["metric.stub"]["properties"]["bins"]

    assert (bins["minimum"], bins["default"], bins["description"]) == (5, 50, "How many.")


@pytest.mark.parametrize("name", names())
def test_takes_every_shipped_file(whole, name):
    tree = tomllib.loads((folder() / f"{name}.toml").read_text(encoding="utf-8"))

    assert valid(tree, whole, whole)


def test_takes_a_resolved_preset(whole, base):
    assert valid(dump(base), whole, whole)


def test_takes_components_by_name_and_by_table(whole, tree):
    tree["stages"][0]["metric"] = "stub"

    assert valid(tree, whole, whole)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("metric", "stubb"),
        ("metric", {"type": "stub", "bns": 3}),
        ("metric", {"type": "stub", "bins": 2}),
        ("metric", {"bins": 32}),
        ("transform", 3),
        ("start", "center"),
        ("scales", "shft"),
        ("scales", ["1"]),
        ("levels", []),
        ("levels", [{"shrink": 0}]),
        ("levels", [{"fraction": 20}]),
        ("level", []),
    ],
)
def test_refuses_what_the_models_refuse(whole, tree, key, value):
    tree["stages"][0][key] = value

    assert not valid(tree, whole, whole)


def test_wants_stages_unless_another_preset_is_extended(whole):
    assert not valid({"name": "x"}, whole, whole)
    assert valid({"extends": "paper-similarity", "seed": 2}, whole, whole)


def test_knows_paths(whole):
    paths = {"extends": "paper-similarity", "stages.0.levels.1": {"shrink": 2}}

    assert valid(paths, whole, whole)
    assert not valid({**paths, "stage.0.levels": []}, whole, whole)
