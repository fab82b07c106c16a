"""A result remembers whose code made it."""

from hashlib import sha256
from pathlib import Path

import pytest

from regframe import Metric, plugins
from regframe.engine.provenance import plugins as told
from regframe.preset import load
from support.plugin_files import GOOD
from support.plugins import FOLDERS, install

pytestmark = pytest.mark.usefixtures("forgotten")


class Bare(Metric):
    """A metric without a name."""

    def value(self, pairs):
        return float(abs(pairs.fixed - pairs.moving).mean())


def test_shipped_components_are_not_listed():
    assert told(load("paper-similarity")) == []


def test_a_file_is_told_with_its_hash(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(GOOD)
    plugins.load(file)

    (one,) = told(load("paper-similarity", {"stages.0.metric": "least-distance"}))

    assert one == {
        "kind": "metric",
        "name": "least-distance",
        "origin": str(file),
        "version": None,
        "sha256": sha256(file.read_bytes()).hexdigest(),
    }


def test_a_distribution_is_told_with_its_version(tmp_path, monkeypatch):
    (folder,) = (each for each in FOLDERS if each.name == "destripe")
    install(folder, tmp_path)
    monkeypatch.syspath_prepend(folder)
    monkeypatch.syspath_prepend(tmp_path)

    (one,) = told(load("paper-similarity", {"filters.moving": ["destripe", "destripe"]}))

    source = folder / "regframe_destripe" / "__init__.py"
    assert one == {
        "kind": "filter",
        "name": "destripe",
        "origin": "regframe-destripe",
        "version": "0.1.0",
        "sha256": sha256(source.read_bytes()).hexdigest(),
    }


def test_a_part_of_a_component_is_told_and_once(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(GOOD)
    plugins.load(file)
    parts = {"type": "sum", "parts": ["mattes", "least-distance", "least-distance"]}

    assert [one["name"] for one in told(load("paper-similarity", {"stages.0.metric": parts}))] == [
        "least-distance"
    ]


def test_a_class_without_a_name_is_told_by_its_own():
    (one,) = told(load("paper-similarity", {"stages.0.metric": Bare()}))

    assert (one["name"], one["origin"], one["version"]) == ("Bare", "this session", None)
    assert one["sha256"] == sha256(Path(__file__).read_bytes()).hexdigest()
