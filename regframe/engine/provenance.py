"""What a result must remember to be made again."""

import os
import platform
import sys
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from regframe.catalog import KINDS
from regframe.component import Component
from regframe.errors import PresetError
from regframe.image import Image
from regframe.io import digest
from regframe.kernels.sharing import threads
from regframe.preset import Preset

PACKAGES = ("regframe", "numpy", "scipy", "numba", "simpleitk", "pydantic")


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that numbers depend on."""
    found = {package: _version(package) or "not installed" for package in PACKAGES}
    return {"python": platform.python_version(), **found}


@cache
def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def provenance(
    preset: Preset, fixed: Image, moving: Image, *, seconds: float, engine: str = "native"
) -> dict[str, Any]:
    """Versions, plugins, machine, seed, inputs with their hashes, and times."""
    return {
        "engine": engine,
        "versions": versions(),
        "plugins": plugins(preset),
        "platform": f"{platform.system()} {platform.machine()}",
        "threads": threads(),
        "processors": os.cpu_count(),
        "seed": preset.seed,
        "fixed": facts(fixed),
        "moving": facts(moving),
        "finished": datetime.now(UTC).isoformat(timespec="seconds"),
        "seconds": round(seconds, 4),
    }


def plugins(preset: Preset) -> list[dict[str, str | None]]:
    """Where each component of a preset comes from that regframe does not ship.

    Returns
    -------
    list of dict
        `kind`, `name`; `origin` as `Registry.origin` tells it, with its `version` if it is a distribution;
        `sha256` of the file that defines the class. What is not known is None.
    """
    found: dict[tuple[str, str], dict[str, str | None]] = {}
    for component in _components(preset):
        registry = next(each for each in KINDS.values() if isinstance(component, each.base))
        cls = type(component)
        try:
            name = registry.name_of(cls)
            origin = registry.origin(name)
        except PresetError:  # built in a script, and never given a name
            name, origin = cls.__qualname__, "this session"
        if origin == "regframe":
            continue
        file = getattr(sys.modules.get(cls.__module__), "__file__", None)
        found[registry.kind, name] = {
            "kind": registry.kind,
            "name": name,
            "origin": origin,
            "version": _version(origin),
            "sha256": sha256(Path(file).read_bytes()).hexdigest() if file else None,
        }
    return list(found.values())


def _components(part: object) -> Iterator[Component]:
    """Every component in a preset, those inside of others too."""
    if isinstance(part, Component):
        yield part
    inner: Sequence[object] = ()
    if isinstance(part, BaseModel):
        inner = [getattr(part, name) for name in type(part).model_fields]
    elif isinstance(part, list | tuple):
        inner = part
    for each in inner:
        yield from _components(each)


def facts(image: Image) -> dict[str, Any]:
    """Name, geometry and hash of an image."""
    grid = image.grid
    return {
        "name": image.name,
        "shape": list(grid.shape),
        "spacing": list(grid.spacing),
        "origin": list(grid.origin),
        "direction": [list(row) for row in grid.direction],
        "pixel_type": str((image.values if image.raw is None else image.raw).dtype),
        "masked": image.mask is not None,
        "sha256": digest(image),
    }
