"""Presets by name: shipped ones, and those that plugins bring."""

import sys

import pytest

from regframe import preset
from regframe.errors import PresetError

MINE = 'about = "Of a plugin."\nextends = "mono-similarity"\n"seed" = 7\n'


@pytest.fixture
def plugin(tmp_path, monkeypatch):
    """Installs a distribution whose package holds a preset and fails when it is imported."""
    monkeypatch.syspath_prepend(tmp_path)

    def install(distribution, name="mine", package="my_package", file="mine.toml"):
        info = tmp_path / f"{distribution}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[regframe.preset]\n{name} = {package}\n")
        (tmp_path / "my_package").mkdir(exist_ok=True)
        (tmp_path / "my_package" / "__init__.py").write_text("raise RuntimeError('code was run')\n")
        (tmp_path / "my_package" / file).write_text(MINE)

    return install


def test_a_plugins_preset_has_its_name_and_runs_no_code(plugin):
    plugin("mine-dist")

    loaded = preset.load("mine")

    assert loaded.name == "mine"
    assert loaded.seed == 7
    assert "mine" in preset.names()
    assert "mine" not in preset.shipped()
    assert preset.origin("mine") == "mine-dist"
    assert "my_package" not in sys.modules


def test_a_plugins_preset_can_be_extended(plugin):
    plugin("mine-dist")

    assert preset.parse({"extends": "mine", "name": "yours"}).seed == 7


def test_a_missing_file_is_told_and_the_rest_is_there(plugin):
    plugin("mine-dist", file="other.toml")

    with pytest.raises(PresetError, match=r"'mine' of mine-dist is not there: .* holds mine\.toml"):
        preset.load("mine")
    assert list(preset.faults()) == ["mine (mine-dist, my_package)"]
    assert preset.load("mono-similarity").name == "mono-similarity"


@pytest.mark.parametrize("package", ["my_package.inner", "no_such_package", "my_package:mine"])
def test_only_a_top_level_package_is_looked_into(plugin, package):
    plugin("mine-dist", package=package)

    with pytest.raises(PresetError, match="must name a top-level package"):
        preset.load("mine")
    assert "my_package" not in sys.modules


def test_a_shipped_name_stays_regframes(plugin):
    plugin("mine-dist", name="mono-similarity", file="mono-similarity.toml")

    assert preset.load("mono-similarity").seed == 1
    assert preset.origin("mono-similarity") == "regframe"
    assert "is taken by regframe" in preset.faults()["mono-similarity (mine-dist, my_package)"]


def test_a_name_of_two_plugins_is_nobodys(plugin):
    plugin("mine-dist")
    plugin("your-dist")

    with pytest.raises(PresetError, match=r"^the preset 'mine' is claimed by .*-dist and .*-dist\. Remove"):
        preset.load("mine")
