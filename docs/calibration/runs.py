"""Runs the cases and keeps the maps that were found; evidence is measured on them afterwards."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, isfinite
from pathlib import Path
from time import process_time

import numpy as np
from cases import Case, random_of

from regframe.engine.native import filtered
from regframe.engine.run import as_preset, register
from regframe.errors import RegframeError
from regframe.geometry import AffineMap, Frame, Grid
from regframe.testing.phantoms import misalignment
from regframe.transforms.warp import Chain, Warp
from regframe.verdict import backward
from regframe.verdict.evidence import Evidence, gather, round_trip

RIGHT_PX = 3.0


@dataclass(frozen=True)
class Row:
    """A case, how far the map that was found is from the truth, and the evidence on it.

    Parameters
    ----------
    preset, kind, name : str
    scenes : tuple of str
    error_px : float or None
        None where every map is wrong.
    evidence : Evidence
    """

    preset: str
    kind: str
    name: str
    scenes: tuple[str, ...]
    error_px: float | None
    evidence: Evidence

    @property
    def near(self) -> bool:
        """Whether the map is within 5 pixels."""
        return self.error_px is not None and self.error_px <= 5.0


def run(case: Case, preset: str, *, back: bool) -> dict:
    """Both searches of a case, as a record that JSON holds; a refusal is a record without maps."""
    fixed, moving, error = case.load()
    found = {"preset": preset, "kind": case.kind, "name": case.name, "scenes": case.scenes}
    began = process_time()
    try:
        result = register(preset, fixed, moving)
    except RegframeError as refusal:
        return {**found, "refused": str(refusal)}
    middle = process_time()
    turned = backward.search(result) if back else None
    spent = {"seconds": middle - began, "seconds_back": process_time() - middle}
    return {
        **found,
        "error_px": None if error is None else error(result.warp),
        "map": result.pixel_matrix.tolist(),
        "back": None if turned is None else turned.as_affine().homogeneous().tolist(),
        "searched_back": back,
        **spent,
    }


def measure(record: dict, case: Case) -> Iterator[Row]:
    """The evidence on the map of a record, and on the same map pushed aside where it was right."""
    fixed, moving, error = case.load()
    there, back = (_warp(record[name], image) for name, image in (("map", fixed), ("back", moving)))
    preset = as_preset(record["preset"])
    images = filtered(preset, fixed, moving)

    def row(kind: str, warp: Warp | Chain) -> Row:
        apart = round_trip(warp, back, fixed.grid, moving.grid) if record["searched_back"] else None
        far = None if error is None else error(warp)
        evidence = gather(*images, warp, round_trip_px=apart)
        return Row(preset.name, kind, case.name, case.scenes, far, evidence)

    yield row(case.kind, there)
    if error is not None and error(there) <= RIGHT_PX:
        # Searches end at the right place or far from it; near misses are what a wrong model leaves.
        yield row("displaced", pushed(there, fixed.grid, random_of(case.kind, case.name)))


def pushed(warp: Warp, grid: Grid, rng: np.random.Generator) -> Chain:
    """A map and, before it, a small motion of the fixed frame: between 2 and 40 pixels, most of them few."""
    length = 2.0 * 20.0 ** rng.uniform()
    share = rng.dirichlet((1.0, 0.5, 0.5)) * length
    radius, towards = float(np.hypot(*grid.shape)) / 2, rng.uniform(0.0, 2.0 * np.pi)
    turn, stretch = share[1:] / radius * rng.choice([-1.0, 1.0], 2)
    shift = share[0] * np.array([np.cos(towards), np.sin(towards)])
    motion = misalignment(grid, grid, angle_deg=np.rad2deg(turn), scale=1.0 + stretch, shift_px=shift)
    return warp @ motion


def _warp(matrix: list | None, image) -> Warp | None:
    if matrix is None:
        return None
    affine = AffineMap.from_homogeneous(np.array(matrix))
    return Warp.of_affine(affine, Frame.about_centre(image.grid))


def records(path: Path) -> Iterator[dict]:
    """What earlier runs left."""
    if path.exists():
        yield from map(json.loads, path.read_text(encoding="utf-8").splitlines())


COLUMNS = (
    "round_trip_px",
    "parts",
    "parts_near",
    "leftover_px",
    "edge_fit",
    "rival",
    "sharpness",
    "overlap",
)


def cells(row: Row) -> list[str]:
    """A row of the table of evidence."""
    numbers = [getattr(row.evidence, name) for name in COLUMNS]
    error = "" if row.error_px is None else f"{row.error_px:.3f}"
    return [row.preset, row.kind, row.name, "|".join(row.scenes), error, *map(_cell, numbers)]


def row_of(cells: list[str]) -> Row:
    """The row that `cells` wrote."""
    preset, kind, name, scenes, error, *numbers = cells
    values = dict(zip(COLUMNS, (None if text == "" else float(text) for text in numbers), strict=True))
    values["parts"] = int(values["parts"])
    evidence = Evidence(**values)
    return Row(preset, kind, name, tuple(scenes.split("|")), float(error) if error else None, evidence)


def _cell(number: float | None) -> str:
    if number is None:
        return ""
    return f"{number:.4g}" if isfinite(number) else str(inf)
