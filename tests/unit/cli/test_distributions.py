"""Each distribution in `plugins/` is found, explained and usable by name."""

import pytest

from regframe import preset
from regframe.catalog import KINDS
from support.plugins import FOLDERS, entries, install, package, project

REGISTRIES = {registry.kind: registry for registry in KINDS.values()}


@pytest.fixture(params=FOLDERS, ids=lambda folder: folder.name)
def folder(request, tmp_path, monkeypatch):
    """One distribution, as good as installed."""
    install(request.param, tmp_path)
    monkeypatch.syspath_prepend(request.param)
    monkeypatch.syspath_prepend(tmp_path)
    return request.param


def component(folder):
    """Registry and name of a distribution's component."""
    (kind, points), *others = ((kind, points) for kind, points in entries(folder).items() if kind != "preset")
    assert not others
    (name,) = points
    return REGISTRIES[kind], name


def preset_name(folder):
    (name,) = entries(folder)["preset"]
    return name


def test_component_is_found_by_name(folder):
    registry, name = component(folder)

    assert registry.origin(name) == project(folder)["name"]
    assert registry.name_of(registry.build(name)) == name
    assert registry.faults() == {}


def test_component_is_listed_and_explained(folder, regframe):
    registry, name = component(folder)

    listed = regframe("list", f"{registry.kind}s").out
    explained = regframe("explain", name)

    assert any(line.startswith(f"{name} ") for line in listed.splitlines())
    assert explained.code == 0
    assert project(folder)["name"] in explained.out


def test_preset_is_found_by_name_and_by_file(folder):
    name = preset_name(folder)

    by_name = preset.load(name)

    assert by_name == preset.load(package(folder) / f"{name}.toml")
    assert by_name.name == name
    assert by_name.about
    assert preset.origin(name) == project(folder)["name"]
    assert preset.faults() == {}


def test_preset_is_listed_and_explained(folder, regframe):
    name = preset_name(folder)

    listed = regframe("list", "presets").out
    explained = regframe("explain", name)

    assert any(line.startswith(f"{name} ") for line in listed.splitlines())
    assert "unusable" not in listed
    assert explained.code == 0


def test_preset_uses_the_component(folder):
    registry, name = component(folder)
    whole = preset.load(preset_name(folder))

    parts = {getattr(stage, registry.kind, None) for stage in whole.stages}
    parts |= {*whole.filters.fixed, *whole.filters.moving}

    assert registry[name] in map(type, parts)
