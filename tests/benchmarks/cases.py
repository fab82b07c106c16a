"""Visual and thermal frames with a known similarity between them: real ones where they are, else phantoms."""

import csv
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from conftest import DATA
from numpy.random import Generator
from scipy import ndimage

from regframe.geometry import AffineMap, Frame, Grid
from regframe.image import Image
from regframe.io import read
from regframe.testing.phantoms import misalignment, visual_thermal
from regframe.transforms.warp import Warp
from regframe.types import Points, Volume

FOLDER = "visual_thermal/roadscene/"
SHAPE = (400, 660)
"""Of phantoms: somewhat larger than the real frames."""
TRIES = 10_000
NET = 21
"""Points along each axis where maps are compared."""


@dataclass(frozen=True, eq=False)
class Scene:
    """Two frames of one scene on one grid, as float64 grey values of 0 to 255."""

    name: str
    visual: Volume
    thermal: Volume


@dataclass(frozen=True, eq=False)
class Case:
    """A pair to register, and the true warp from fixed to moving points."""

    name: str
    fixed: Image
    moving: Image
    truth: Warp


@dataclass(frozen=True)
class Reach:
    """How far a drawn similarity may depart from none, and the share of the frame that is kept.

    Parameters
    ----------
    angle_deg : float
    log_scale : float
    shift : float
        Of the kept frame's width, along each axis.
    kept : float
    """

    angle_deg: float
    log_scale: float
    shift: float
    kept: float


def real() -> bool:
    """Whether the real frames are here."""
    return (DATA / "pairs.csv").is_file()


def scenes(most: int | None = None) -> list[Scene]:
    """Real scenes, evenly chosen from the list if there are more than wanted; phantoms where they are not."""
    if not real():
        return [phantom(seed) for seed in range(1, (most or 8) + 1)]
    with (DATA / "pairs.csv").open(encoding="utf-8") as lines:
        rows = [row for row in csv.DictReader(lines) if row["fixed"].startswith(FOLDER)]
    chosen = np.linspace(0, len(rows) - 1, min(most or len(rows), len(rows))).round().astype(int)
    return [
        Scene(rows[i]["name"], grey(DATA / rows[i]["fixed"]), grey(DATA / rows[i]["moving"])) for i in chosen
    ]


def phantom(seed: int) -> Scene:
    """A painted street, both cameras at one place."""
    grid = Grid.of_shape(SHAPE)
    pair = visual_thermal(seed, SHAPE, thermal_shape=SHAPE, truth=misalignment(grid, grid))
    counts = np.asarray(pair.moving.values, np.float64)
    low, high = np.percentile(counts, [0.1, 99.9])
    thermal = np.clip((counts - low) / (high - low), 0.0, 1.0) * 255.0
    return Scene(f"phantom-{seed}", np.asarray(pair.fixed.values, np.float64), thermal)


def grey(path: Path) -> Volume:
    """A file's grey values."""
    return np.asarray(read(path).values, np.float64)


def drawn(scene: Scene, reach: Reach, rng: Generator) -> Case:
    """A case of a random similarity within reach, all of whose moving pixels were photographed."""
    grid, _ = kept(scene, reach.kept)
    for _ in range(TRIES):
        angle, log_scale = rng.uniform(-1.0, 1.0, 2) * (reach.angle_deg, reach.log_scale)
        shift = rng.uniform(-reach.shift, reach.shift, 2) * grid.shape[1]
        made = placed(
            scene,
            reach.kept,
            misalignment(grid, grid, angle_deg=angle, scale=float(np.exp(log_scale)), shift_px=tuple(shift)),
        )
        if made is not None:
            return made
    message = f"{scene.name}: no similarity within {reach} shows only what was photographed."
    raise RuntimeError(message)


def kept(scene: Scene, share: float) -> tuple[Grid, tuple[int, int]]:
    """The grid of the middle part of a scene, and its first pixel."""
    shape = [int(n * share) for n in scene.visual.shape]
    first = [(n - m) // 2 for n, m in zip(scene.visual.shape, shape, strict=True)]
    return Grid.of_shape(shape), (first[0], first[1])


def placed(scene: Scene, share: float, truth: Warp) -> Case | None:
    """The middle of the visual frame, and the thermal one as a camera at `truth` would see it.

    None where that camera would look beyond the frame.
    """
    grid, first = kept(scene, share)
    affine = truth.transform.as_affine(truth.params, truth.frame)
    assert affine is not None
    seen = moving_to_scene(affine, first)
    corners = seen(grid.corners())
    height, width = scene.visual.shape
    if corners.min() < 0.0 or np.any(corners > (width - 1.0, height - 1.0)):
        return None
    places = seen(grid.points(grid.all_indices()))[:, ::-1].T
    thermal = ndimage.map_coordinates(scene.thermal, places, order=3, mode="nearest").reshape(grid.shape)
    rows, columns = (slice(at, at + n) for at, n in zip(first, grid.shape, strict=True))
    visual = scene.visual[rows, columns]
    return Case(scene.name, frame(visual, "visual"), frame(thermal, "thermal"), truth)


def moving_to_scene(affine: AffineMap, first: tuple[int, int]) -> AffineMap:
    """From the moving frame's points to those of the whole scene."""
    back = affine.inverse()
    return AffineMap(back.matrix, back.offset + np.array(first[::-1], np.float64))


def frame(values: Volume, name: str) -> Image:
    """An 8-bit camera frame."""
    return Image.of_array(np.clip(np.round(values), 0, 255).astype(np.uint8), name=name)


def with_thermal(case: Case, values: Volume, *, bits: int = 8) -> Case:
    """The case with other thermal values, of as many bits."""
    kind = np.uint8 if bits == 8 else np.uint16
    whole = np.clip(np.round(values), 0, 2**bits - 1).astype(kind)
    return replace(case, moving=Image.of_array(whole, name="thermal"))


def each(reach: Reach, *, most: int | None = None, seed: int = 1) -> Iterator[Case]:
    """One case a scene, the same ones for the same seed."""
    for number, scene in enumerate(scenes(most)):
        yield drawn(scene, reach, np.random.default_rng((seed, number)))


def seen(fixed: Grid, moving: Grid, truth: Callable[[Points], Points]) -> Points:
    """A net of fixed pixels, those whose places lie in the moving frame, (n, 2)."""
    rows, columns = (np.linspace(0.0, n - 1.0, NET) for n in fixed.shape)
    points = fixed.points(np.stack(np.meshgrid(rows, columns, indexing="ij"), axis=-1).reshape(-1, 2))
    places = moving.point_to_index(truth(points))[:, ::-1]
    return points[np.all((places >= 0.0) & (places <= np.array(moving.shape) - 1.0), axis=1)]


def apart(one: Points, other: Points) -> float:
    """Mean distance between points of two lists."""
    return float(np.linalg.norm(one - other, axis=1).mean())


def about(case: Case) -> Frame:
    """The frame that similarities of a case turn about."""
    return Frame.about_centre(case.fixed.grid)
