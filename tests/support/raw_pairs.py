"""Genuine unaligned visual and thermal pairs, and how far a warp is from their ground truth."""

import csv
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from regframe.image import Image
from regframe.io import read

WIDEST = 960


@dataclass(frozen=True, eq=False)
class RawPair:
    """A visual frame of at most 960 pixels across, a thermal one, and points that match.

    Errors are mean distances in thermal pixels: over a net of visual pixels that the true homography puts
    into the thermal frame, or over landmarks.
    """

    name: str
    source: str
    fixed: Image
    moving: Image
    seen: np.ndarray
    wanted: np.ndarray
    floor: float

    def error(self, warp) -> float:
        return float(np.linalg.norm(warp(self.seen) - self.wanted, axis=1).mean())


def raw_pairs(data: Path, sources: tuple[str, ...], names: tuple[str, ...] = ()):
    """Each pair of some sources whose name ends as wanted, as data/README.md describes them."""
    with (data / "pairs.csv").open() as lines:
        rows = [row for row in csv.DictReader(lines) if row["ground_truth"] and row["aligned"] == "false"]
    for row in rows:
        source = next((one for one in sources if f"/{one}/" in row["fixed"]), None)
        if source is None or (names and not row["name"].endswith(names)):
            continue
        truth = json.loads((data / row["ground_truth"]).read_text())
        fixed, moving = read(data / row["fixed"]), read(data / row["moving"])
        seen, wanted = _matches(truth, fixed.grid.shape, moving.grid.shape)
        small = _narrowed(fixed)
        ratio = small.grid.shape[1] / fixed.grid.shape[1]
        floor = truth["model_floor"]["similarity_rms_px"]
        yield RawPair(row["name"], source, small, moving, (seen + 0.5) * ratio - 0.5, wanted, floor)


def _matches(truth, fixed, moving):
    if truth["kind"] == "landmarks":
        return np.array(truth["landmarks_fixed"], float), np.array(truth["landmarks_moving"], float)
    matrix = np.array(truth["matrix"], float)
    across, down = np.meshgrid(np.linspace(0, fixed[1] - 1, 21), np.linspace(0, fixed[0] - 1, 21))
    seen = np.column_stack([across.ravel(), down.ravel()])
    lifted = np.column_stack([seen, np.ones(len(seen))]) @ matrix.T
    wanted = lifted[:, :2] / lifted[:, 2:]
    inside = np.all((wanted >= 0) & (wanted <= np.array(moving[::-1]) - 1), axis=1)
    return seen[inside], wanted[inside]


def _narrowed(image: Image) -> Image:
    """The grey image at most 960 pixels across, each pixel the mean of what it covers."""
    height, width = image.grid.shape
    if width <= WIDEST:
        return Image.of_array(np.asarray(image.values), name=image.name)
    shape = (round(height * WIDEST / width), WIDEST)
    values = np.asarray(image.values, np.float64)
    for axis, count in enumerate(shape):
        values = (
            _shares(values.shape[axis], count) @ values if axis == 0 else values @ _shares(width, count).T
        )
    return Image.of_array(values.astype(np.float32), name=image.name)


def _shares(old: int, new: int) -> np.ndarray:
    """Weights of the old pixels in each new one, by the length that they share, (new, old)."""
    edges = np.arange(new + 1) * old / new
    low, high = edges[:-1, None], edges[1:, None]
    pixels = np.arange(old)
    shared = np.clip(np.minimum(high, pixels + 1) - np.maximum(low, pixels), 0, None)
    return shared / shared.sum(axis=1, keepdims=True)
