"""Examples in docstrings run; every public function has one."""

import ast
import doctest
from importlib import import_module
from inspect import getdoc, isfunction

import pytest

import regframe
from house.source import modules, tree

FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def with_examples() -> list[str]:
    """Modules whose text holds a prompt."""
    return [name for name in modules() if ">>> " in ast.unparse(tree(name))]


@pytest.mark.parametrize("module", with_examples())
def test_examples_hold(module, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    failed, tried = doctest.testmod(import_module(module), optionflags=FLAGS)

    assert tried > 0
    assert failed == 0


@pytest.mark.parametrize("name", [name for name in regframe.__all__ if name.islower() and name[0] != "_"])
def test_a_public_function_has_an_example(name):
    function = getattr(regframe, name)

    assert isfunction(function)
    assert ">>> " in (getdoc(function) or "")
