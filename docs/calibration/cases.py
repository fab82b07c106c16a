"""Pairs of images whose answer is known, or known not to exist: what the verdict is calibrated on."""

import csv
import json
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from itertools import permutations
from pathlib import Path

import numpy as np
from spoils import SPOILS, Error, error_of

from regframe.engine.resampling import resample
from regframe.geometry import Grid
from regframe.image import Image
from regframe.interpolators.bspline import BSpline
from regframe.interpolators.linear import Linear
from regframe.io import read
from regframe.kernels.gaussian import smooth
from regframe.testing.phantoms import misalignment, visual_thermal
from regframe.transforms.warp import Warp

LEVELS = {  # rotation in degrees, log scale, shift and size of the crop as shares of the frame
    "easy": (2.0, 0.03, 0.03, 0.80),
    "medium": (6.0, 0.08, 0.07, 0.70),
    "hard": (15.0, 0.18, 0.12, 0.58),
}
WRONG_A_TURN = 4
WIDEST = 960  # pixels of a raw visual frame


@dataclass(frozen=True)
class Case:
    """A pair of images with a name, how it was made, and how far a map is from the truth.

    Parameters
    ----------
    kind : str
    name : str
    scenes : tuple of str
        Whose images it is made of; halves are kept apart by them.
    load : callable
        The images, and the error of a map in moving pixels; None where every map is wrong.
    """

    kind: str
    name: str
    scenes: tuple[str, ...]
    load: Callable[[], tuple[Image, Image, Error | None]]


def cases(data: Path, times: int) -> Iterator[Case]:
    """All cases; `times` warps of each scene and level."""
    with (data / "pairs.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["fixed"].startswith("visual_thermal/")]
    paths = {row["name"]: (data / row["fixed"], data / row["moving"]) for row in rows}
    aligned = [row["name"] for row in rows if row["aligned"] == "true"]
    for level in LEVELS:
        for name in aligned:
            for time in range(times):
                yield Case(
                    f"warp-{level}",
                    f"{name}-{time}",
                    (scene(name),),
                    partial(_warped, *paths[name], level, time),
                )
    for row in rows:
        if row["ground_truth"]:
            load = partial(_raw, *paths[row["name"]], data / row["ground_truth"])
            yield Case("raw", row["name"], (scene(row["name"]),), load)
    yield from _phantoms()
    for spoil in SPOILS:
        for name in aligned:
            yield Case(spoil, name, (scene(name),), partial(_spoilt, *paths[name], spoil))
    # Every ordered pair of scenes, shuffled, so that a part of them is a fair sample.
    wrong = list(permutations(aligned, 2))
    np.random.default_rng(1).shuffle(wrong)
    for below, above in wrong:
        load = partial(_wrong, paths[below][0], paths[above][1])
        yield Case("wrong", f"{below}|{above}", (scene(below), scene(above)), load)


def in_turn(found: Iterable[Case]) -> list[Case]:
    """One case of each kind, and some wrong pairs, in turn, so that the first n are a fair sample."""
    seen: Counter[str] = Counter()
    turns = []
    for case in found:
        turns.append((seen[case.kind] // (WRONG_A_TURN if case.kind == "wrong" else 1), len(turns), case))
        seen[case.kind] += 1
    return [case for _, _, case in sorted(turns, key=lambda one: one[:2])]


def scene(name: str) -> str:
    """The scene of a pair; frames of one place are one scene."""
    short = name.removeprefix("roadscene_").removeprefix("raw_")
    return short.rpartition("_")[0] if short.startswith("metu") else short


def _phantoms() -> Iterator[Case]:
    for shape in ((480, 640), (240, 320), (120, 160)):
        for seed in range(1, 9):
            name = f"{shape[1]}x{shape[0]}-{seed}"
            yield Case("phantom", name, (f"phantom-{seed}",), partial(_phantom, shape, seed))


@cache
def _frame(path: Path) -> Image:
    image = read(path)
    return Image.of_array(np.asarray(image.values, np.float32), name=path.name)


def random_of(*words: object) -> np.random.Generator:
    """Chance that depends on nothing but some words."""
    return np.random.default_rng(zlib.crc32("|".join(map(str, words)).encode()))


def _draw(level: str, shape: tuple[int, int], rng: np.random.Generator) -> Warp:
    """A similarity of a level's size about the centre of a frame."""
    turn, stretch, shift, _ = LEVELS[level]
    grid = Grid.of_shape(shape)
    return misalignment(
        grid,
        grid,
        angle_deg=rng.uniform(-turn, turn),
        scale=float(np.exp(rng.uniform(-stretch, stretch))),
        shift_px=rng.uniform(-shift, shift, 2) * shape[1],
    )


def _cut(visual: Image, thermal: Image, level: str, rng: np.random.Generator) -> tuple[Image, Image, Warp]:
    """The middle of both frames, the thermal one through a known map; no frame shows what is not there."""
    share = LEVELS[level][3]
    shape = tuple(int(n * share) for n in visual.grid.shape)
    corner = [(n - m) // 2 for n, m in zip(visual.grid.shape, shape, strict=True)]
    fixed = visual.values[tuple(slice(o, o + n) for o, n in zip(corner, shape, strict=True))]
    grid, offset = Grid.of_shape(shape), np.array(corner[::-1], float)
    while True:
        truth = _draw(level, shape, rng)
        seen = truth.inverse()(grid.corners()) + offset
        if thermal.grid.inside(thermal.grid.indices(seen)).all():
            break
    # The thermal frame, placed so that the crop's first pixel lies at the origin.
    source = Grid(thermal.grid.shape, (1.0, 1.0), tuple(-offset), thermal.grid.direction)
    moving, _ = resample(thermal.values, source, grid, truth.inverse(), BSpline())
    limits = float(thermal.values.min()), float(thermal.values.max())
    return (
        Image.of_array(np.ascontiguousarray(fixed), name="visual"),
        Image.of_array(np.clip(moving, *limits).astype(np.float32), name="thermal"),
        truth,
    )


def _warped(visual: Path, thermal: Path, level: str, time: int) -> tuple[Image, Image, Error]:
    fixed, moving, truth = _cut(_frame(visual), _frame(thermal), level, random_of(visual.stem, level, time))
    return fixed, moving, error_of(truth, fixed.grid)


def _raw(visual: Path, thermal: Path, truth: Path) -> tuple[Image, Image, Error]:
    """Frames as the cameras gave them, the visual one made smaller, and the truth found on it."""
    whole, moving = _frame(visual), _frame(thermal)
    step = max(1.0, whole.grid.shape[1] / WIDEST)
    fixed = _smaller(whole, step)
    below, above = _true_points(json.loads(truth.read_text(encoding="utf-8")), whole.grid, moving.grid)
    below = (below + 0.5) / step - 0.5
    return fixed, moving, lambda warp: float(np.linalg.norm(warp(below) - above, axis=1).mean())


def _smaller(image: Image, step: float) -> Image:
    if step == 1.0:
        return image
    shape = tuple(round(n / step) for n in image.grid.shape)
    origin = (0.5 * step - 0.5,) * 2
    grid = Grid(shape, (step, step), origin, image.grid.direction)
    blurred = smooth(image.values, (0.4 * step,) * 2)
    at = grid.all_indices() * step + origin[0]
    values = Linear().sample(np.asarray(blurred, np.float64), at).reshape(shape)
    return Image.of_array(values.astype(np.float32), name=image.name)


def _true_points(truth: dict, fixed: Grid, moving: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Points of the fixed frame, and where they are in the moving one."""
    if truth["kind"] == "landmarks":
        return np.array(truth["landmarks_fixed"], float), np.array(truth["landmarks_moving"], float)
    matrix = np.array(truth.get("matrix_refined") or truth["matrix"], float)
    matrix = matrix if len(matrix) == 3 else np.vstack([matrix, [0.0, 0.0, 1.0]])
    axes = [np.linspace(0.0, n - 1.0, 21) for n in fixed.shape[::-1]]
    below = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    above = np.c_[below, np.ones(len(below))] @ matrix.T
    above = above[:, :2] / above[:, 2:]
    met = moving.inside(above[:, ::-1])
    return below[met], above[met]


def _phantom(shape: tuple[int, int], seed: int) -> tuple[Image, Image, Error]:
    made = visual_thermal(seed, shape)
    return made.fixed, made.moving, error_of(made.truth, made.fixed.grid)


def _wrong(visual: Path, thermal: Path) -> tuple[Image, Image, None]:
    return _frame(visual), _frame(thermal), None


def _spoilt(visual: Path, thermal: Path, spoil: str) -> tuple[Image, Image, Error | None]:
    """A medium case made hard or hopeless."""
    rng = random_of(visual.stem, spoil)
    fixed, moving, truth = _cut(_frame(visual), _frame(thermal), "medium", rng)
    return SPOILS[spoil](fixed, moving, truth, rng)
