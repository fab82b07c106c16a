"""Each distribution in `plugins/` has the same layout, small and whole."""

import ast
import re
import sys
import tomllib

import pytest

from house.source import REPOSITORY, tree
from support.plugins import FOLDERS, entries, package, project

SETTINGS = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))
each = pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)


def conformance(folder):
    return folder / "tests" / f"test_{folder.name.replace('-', '_')}.py"


def test_there_are_plugins():
    assert FOLDERS


@each
def test_names_agree(folder):
    name, (kind, *_) = folder.name, [kind for kind in entries(folder) if kind != "preset"]
    ((entry, place),) = entries(folder)[kind].items()

    assert entry == name
    assert project(folder)["name"] == f"regframe-{name}"
    assert package(folder).name == f"regframe_{name.replace('-', '_')}"
    assert place.partition(":")[0] == package(folder).name


@each
def test_files_are_these(folder):
    found = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    found = {name for name in found if "__pycache__" not in name}

    inner = package(folder).name
    (preset,) = entries(folder)["preset"]
    tests = {conformance(folder).relative_to(folder).as_posix(), "tests/test_twin.py"}
    made = {"pyproject.toml", "README.md", f"{inner}/__init__.py", f"{inner}/{preset}.toml"}
    assert found == made | tests


@each
def test_conformance_is_one_line_after_the_imports(folder):
    body = ast.parse(conformance(folder).read_text(encoding="utf-8")).body

    assert [type(node) for node in body] == [ast.ImportFrom, ast.ImportFrom, ast.Assign]


@each
def test_the_component_is_all_it_offers(folder):
    points = {kind: points for kind, points in entries(folder).items() if kind != "preset"}
    places = {place for each in points.values() for place in each.values()}

    public = {
        node.name
        for node in tree(package(folder).name).body
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_")
    }

    assert {f"{package(folder).name}:{name}" for name in public} == places


@each
def test_dependencies_are_the_imports(folder):
    imported = {
        (node.module or "") if isinstance(node, ast.ImportFrom) else node.names[0].name
        for node in ast.walk(tree(package(folder).name))
        if isinstance(node, ast.Import | ast.ImportFrom)
    }
    needed = {name.partition(".")[0] for name in imported} - sys.stdlib_module_names

    named = {re.split(r"[<>=]", each)[0] for each in project(folder)["dependencies"]}
    assert named == needed


def test_all_are_on_the_tests_path():
    path = SETTINGS["tool"]["pytest"]["ini_options"]["pythonpath"]

    assert path == ["tests", *(f"plugins/{folder.name}" for folder in FOLDERS)]
