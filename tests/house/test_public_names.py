"""The package's front door: what is offered is there, and is what type checkers see."""

import ast
from importlib import metadata
from pathlib import Path

import pytest

import regframe
from house.source import PACKAGE, modules, path_of, tree


def declared() -> set[str]:
    """Names imported for type checkers."""
    guarded = [node for node in tree("regframe").body if isinstance(node, ast.If)]
    found = [
        statement for node in guarded for statement in node.body if isinstance(statement, ast.ImportFrom)
    ]
    return {alias.asname or alias.name for statement in found for alias in statement.names}


@pytest.mark.parametrize("name", regframe.__all__)
def test_a_public_name_is_there(name):
    assert getattr(regframe, name) is not None


def test_type_checkers_see_the_same_names():
    assert declared() | {"__version__"} == set(regframe.__all__)


def test_names_are_listed_once():
    assert len(set(regframe.__all__)) == len(regframe.__all__)


def test_dir_lists_the_public_names():
    assert set(regframe.__all__) <= set(dir(regframe))


def test_an_unknown_name_is_refused():
    with pytest.raises(AttributeError, match="no attribute 'registr'"):
        _ = regframe.registr


def test_version_is_that_of_the_installed_distribution():
    assert metadata.version("regframe") == regframe.__version__


def test_the_installed_package_is_this_checkout():
    """Else the tests judge code that is not here: install again."""
    installed = Path(regframe.__file__).parent

    other = [
        module
        for module in modules()
        if (installed / path_of(module).relative_to(PACKAGE)).read_bytes() != path_of(module).read_bytes()
    ]

    assert other == []
