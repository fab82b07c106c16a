"""What a result must remember to be made again."""

import os
import platform
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from regframe.image import Image
from regframe.io import digest
from regframe.kernels.jit import threads
from regframe.preset import Preset

PACKAGES = ("regframe", "numpy", "scipy", "numba", "simpleitk", "pydantic")


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that numbers depend on."""
    found = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def provenance(
    preset: Preset, fixed: Image, moving: Image, *, seconds: float, engine: str = "native"
) -> dict[str, Any]:
    """Versions, machine, seed, inputs with their hashes, and times."""
    return {
        "engine": engine,
        "versions": versions(),
        "platform": f"{platform.system()} {platform.machine()}",
        "threads": threads(),
        "processors": os.cpu_count(),
        "seed": preset.seed,
        "fixed": facts(fixed),
        "moving": facts(moving),
        "finished": datetime.now(UTC).isoformat(timespec="seconds"),
        "seconds": round(seconds, 4),
    }


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
