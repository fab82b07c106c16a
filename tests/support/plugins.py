"""The distributions in `plugins/`, put on the import path as if they were installed."""

import tomllib
from pathlib import Path
from typing import Any

from house.source import REPOSITORY

FOLDERS = sorted(path.parent for path in (REPOSITORY / "plugins").glob("*/pyproject.toml"))


def project(folder: Path) -> dict[str, Any]:
    """The `[project]` table of a distribution."""
    table: dict[str, Any] = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return table


def entries(folder: Path) -> dict[str, dict[str, str]]:
    """Entry points of a distribution by their kind: name to place."""
    return {
        group.removeprefix("regframe."): points for group, points in project(folder)["entry-points"].items()
    }


def package(folder: Path) -> Path:
    """The folder of a distribution's one package."""
    (found,) = folder.glob("regframe_*")
    return found


def everywhere(into: Path, monkeypatch: Any) -> None:
    """All of them on the path, as good as installed."""
    for folder in FOLDERS:
        install(folder, into)
        monkeypatch.syspath_prepend(folder)
    monkeypatch.syspath_prepend(into)


def install(folder: Path, into: Path) -> None:
    """Write what an installer would write about a distribution, but for its code."""
    table = project(folder)
    info = into / f"{table['name'].replace('-', '_')}-{table['version']}.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {table['name']}\nVersion: {table['version']}\n"
    )
    groups = [
        "\n".join([f"[{group}]", *(f"{name} = {place}" for name, place in points.items())])
        for group, points in table["entry-points"].items()
    ]
    (info / "entry_points.txt").write_text("\n\n".join(groups) + "\n")
