"""Slices of heads by two methods, and how far a map is from their ground truth."""

import csv
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import ndimage

from regframe.image import Image
from regframe.io import read

SHIFTS = ((0.0, 0.0), (10.0, -6.0), (-8.0, 4.0), (6.0, 8.0))
"""Put on turned images in this order, pixels."""


@dataclass(frozen=True, eq=False)
class BrainPair:
    """Two slices, and the published map from fixed to moving pixels, a matrix of 3 x 3."""

    name: str
    fixed: Image
    moving: Image
    truth: np.ndarray

    def apart(self, found, wanted=None) -> float:
        """Mean distance of two maps over a net of fixed pixels that the second puts into the moving image."""
        wanted = self.truth if wanted is None else wanted
        height, width = self.fixed.grid.shape
        y, x = np.mgrid[0:height:8, 0:width:8].reshape(2, -1)
        net = np.stack([x, y, np.ones(x.size)])
        there, here = (wanted @ net)[:2], (found @ net)[:2]
        most = np.array(self.moving.grid.shape[::-1])[:, None] - 1
        inside = np.all((there >= 0) & (there <= most), axis=0)
        return float(np.linalg.norm(here - there, axis=0)[inside].mean())

    def residual(self, found) -> tuple[float, float, float]:
        """What is left of a map after the published one: degrees, and pixels right and down at the middle."""
        left = np.linalg.inv(self.truth) @ found
        middle = np.array([*(np.array(self.fixed.grid.shape[::-1]) - 1) / 2, 1.0])
        right, down, _ = left @ middle - middle
        return float(np.degrees(np.arctan2(left[1, 0], left[0, 0]))), float(right), float(down)


def brain_pairs(data: Path, source: str) -> list[BrainPair]:
    """The pairs of `itk_brain` or `mr_pet` on grids without a direction, as data/README.md describes them."""
    with (data / "pairs.csv").open(encoding="utf-8") as lines:
        rows = [row for row in csv.DictReader(lines) if f"/{source}/" in row["fixed"]]
    return [
        BrainPair(
            row["name"],
            read(data / row["fixed"]),
            read(data / row["moving"]),
            np.vstack([_matrix(data, row["ground_truth"])[:2], [0.0, 0.0, 1.0]]),
        )
        for row in rows
        if row["fixed"].endswith(".png")
    ]


def turned(pair: BrainPair, angle_deg: float, shift=(0.0, 0.0)) -> tuple[BrainPair, np.ndarray]:
    """The pair with its moving image turned about its middle and shifted, and the map that did it."""
    angle = np.radians(angle_deg)
    more = np.eye(3)
    more[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    middle = (np.array(pair.moving.grid.shape[::-1]) - 1) / 2
    more[:2, 2] = middle - more[:2, :2] @ middle + shift
    raw = pair.moving.raw
    back = np.linalg.inv(more)[[1, 0]][:, [1, 0, 2]]  # rows and columns before x and y
    planes = np.moveaxis(np.atleast_3d(raw), -1, 0).astype(np.float64)
    seen = [ndimage.affine_transform(plane, back[:, :2], back[:, 2], order=1) for plane in planes]
    picture = np.round(np.stack(seen, axis=-1)).astype(raw.dtype).reshape(raw.shape)
    return BrainPair(pair.name, pair.fixed, Image.of_array(picture), more @ pair.truth), more


def _matrix(data, name):
    """The identity where no file says otherwise."""
    return np.array(json.loads((data / name).read_text())["matrix"], float) if name else np.eye(3)
