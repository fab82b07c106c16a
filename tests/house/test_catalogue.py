"""The catalogue names every component there is, and each is what it says."""

import ast
import re
from inspect import isabstract
from typing import get_args

import pytest

from house.source import modules, tree
from regframe.catalog import KINDS
from regframe.component import Component

ENTRIES = [
    (kind, name)
    for kind, registry in KINDS.items()
    for name in registry.names()
    if registry.origin(name) == "regframe"
]
BASES = {
    "filters": "Filter",
    "interpolators": "Interpolator",
    "metrics": "Metric",
    "optimizers": "Optimizer",
    "transforms": "Transform",
}


def snake(name: str) -> str:
    return name.replace("-", "_")


def base_of(kind: str) -> type[Component]:
    module = __import__(f"regframe.{kind}.base", fromlist=[BASES[kind]])
    base: type[Component] = getattr(module, BASES[kind])
    return base


def written_tables() -> list[list[str]]:
    """The names of each table in the order in which catalog.py lists them."""
    calls = [node for node in ast.walk(tree("regframe.catalog")) if isinstance(node, ast.Call)]
    tables = [argument for call in calls for argument in call.args if isinstance(argument, ast.Dict)]
    return [[str(ast.literal_eval(key)) for key in table.keys if key is not None] for table in tables]


def test_has_the_five_kinds():
    assert KINDS.keys() == BASES.keys()


def test_is_sorted():
    tables = written_tables()

    assert len(tables) == len(KINDS)
    assert tables == [sorted(table) for table in tables]


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_names_every_component_module(kind):
    """A module of a component package that is not in the catalogue holds no concrete component."""
    listed = {snake(name) for name in KINDS[kind].names() if KINDS[kind].origin(name) == "regframe"}
    others = [
        name
        for name in modules()
        if name.startswith(f"regframe.{kind}.") and name.rpartition(".")[2] not in listed
    ]

    concrete = {
        f"{name}.{cls.__qualname__}"
        for name in others
        for cls in vars(__import__(name, fromlist=["_"])).values()
        if isinstance(cls, type)
        and issubclass(cls, Component)
        and cls.__module__ == name
        and not isabstract(cls)
    }

    assert concrete == set()


@pytest.mark.parametrize(("kind", "name"), ENTRIES)
def test_entry_derives_from_its_base(kind, name):
    assert issubclass(KINDS[kind][name], base_of(kind))


@pytest.mark.parametrize(("kind", "name"), ENTRIES)
def test_entry_stands_in_a_module_of_its_name(kind, name):
    assert KINDS[kind][name].__module__ == f"regframe.{kind}.{snake(name)}"


@pytest.mark.parametrize(("kind", "name"), ENTRIES)
def test_entry_documents_itself_and_its_options(kind, name):
    cls = KINDS[kind][name]

    assert re.match(r"\S.*\.", (cls.__doc__ or "").partition("\n\n")[0], re.DOTALL)
    assert [option for option, field in cls.model_fields.items() if not field.description] == []


@pytest.mark.parametrize(("kind", "name"), ENTRIES)
def test_entry_is_final(kind, name):
    assert getattr(KINDS[kind][name], "__final__", False)


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_base_refuses_to_be_instantiated(kind):
    base = base_of(kind)

    with pytest.raises(TypeError, match="abstract"):
        base()


def test_engine_refuses_to_be_instantiated():
    from regframe.engine.base import Engine

    with pytest.raises(TypeError, match="abstract"):
        Engine()


def test_options_are_never_lists():
    """A frozen component with a list or dict in it is not frozen."""
    mutable = {
        f"{kind}.{name}.{option}"
        for kind, name in ENTRIES
        for option, field in KINDS[kind][name].model_fields.items()
        if {list, dict, set} & {field.annotation, *get_args(field.annotation)}
    }

    assert mutable == set()
