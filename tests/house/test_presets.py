"""Shipped presets load, and every component is used by one or is excused in the documents."""

import re

import pytest

from house.source import REPOSITORY
from regframe import preset
from regframe.catalog import KINDS

FILES = sorted((REPOSITORY / "presets").glob("*.toml"), key=lambda path: path.stem)
EXCUSES = REPOSITORY / "docs" / "how-to" / "choose-a-preset.md"
HEADING = "## Components that no preset uses"


def used() -> set[tuple[str, str]]:
    """Kind and name of every component in a shipped preset."""
    found = set()
    for path in FILES:
        whole = preset.load(path)
        for image in (*whole.filters.fixed, *whole.filters.moving):
            found.add(("filters", KINDS["filters"].name_of(image)))
        for stage in whole.stages:
            for kind in ("transforms", "interpolators", "metrics", "optimizers"):
                found.add((kind, KINDS[kind].name_of(getattr(stage, kind.removesuffix("s")))))
    return found


def excused() -> set[str]:
    """Names listed, each with a reason, under the heading."""
    _, _, section = EXCUSES.read_text(encoding="utf-8").partition(HEADING)
    return set(re.findall(r"^- `([a-z-]+)`: \S", section.partition("\n## ")[0], re.MULTILINE))


def test_there_are_presets():
    assert len(FILES) > 0


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_loads_from_its_file(path):
    whole = preset.load(path)

    assert whole.name == path.stem
    assert whole.about


def test_installed_presets_are_those_of_the_checkout():
    assert preset.shipped() == [path.stem for path in FILES]


@pytest.mark.parametrize("name", [path.stem for path in FILES])
def test_loads_by_name(name):
    assert preset.load(name) == preset.load(REPOSITORY / "presets" / f"{name}.toml")


def test_every_component_is_used_or_excused():
    known = {
        (kind, name)
        for kind, registry in KINDS.items()
        for name in registry.names()
        if registry.origin(name) == "regframe"
    }

    unused = {name for kind, name in known - used()}

    assert unused == excused()
