"""Small modules, small functions, few parameters."""

import ast

import pytest

from house.source import functions, modules, path_of, plugins

MODULE_LINES, FUNCTION_LINES, PARAMETERS, KERNEL_PARAMETERS = 400, 40, 6, 10
EVERY = [*modules(), *plugins()]


def size(function: ast.FunctionDef) -> int:
    """Lines of code from `def` to the end, without the docstring."""
    lines = (function.end_lineno or 0) - function.lineno + 1
    first = function.body[0]
    if ast.get_docstring(function) is not None and len(function.body) > 1:
        lines -= (first.end_lineno or 0) - first.lineno + 1
    return lines


def parameters(function: ast.FunctionDef) -> int:
    """Number of parameters, without self and cls."""
    given = function.args
    names = [argument.arg for argument in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    return len([name for name in names if name not in ("self", "cls")])


@pytest.mark.parametrize("module", EVERY)
def test_a_module_is_short(module):
    assert len(path_of(module).read_text(encoding="utf-8").splitlines()) <= MODULE_LINES


@pytest.mark.parametrize("module", EVERY)
def test_a_function_is_short(module):
    long = {name: size(function) for name, function in functions(module) if size(function) > FUNCTION_LINES}

    assert long == {}


# A command's parameters are its options, made by typer, so the command line is left out.
@pytest.mark.parametrize("module", [name for name in EVERY if not name.startswith("regframe.cli")])
def test_a_function_has_few_parameters(module):
    most = KERNEL_PARAMETERS if module.startswith("regframe.kernels.") else PARAMETERS
    many = {name: parameters(function) for name, function in functions(module) if parameters(function) > most}

    assert many == {}


@pytest.mark.parametrize("module", EVERY)
def test_nothing_is_left_for_later(module):
    text = path_of(module).read_text(encoding="utf-8")

    assert "NotImplementedError" not in text
    assert "TODO" not in text
    assert "FIXME" not in text


@pytest.mark.parametrize("module", [name for name in EVERY if path_of(name).stat().st_size > 0])
def test_a_module_says_what_it_is_for(module):
    sentence = (ast.get_docstring(ast.parse(path_of(module).read_text(encoding="utf-8"))) or "").splitlines()[
        0
    ]

    assert sentence.endswith(".")
