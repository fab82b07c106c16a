"""Known homographies put on aligned pairs: how near `visual-thermal-projective` ends, and how alike.

``PYTHONPATH=tests python -m benchmarks.homographies`` prints a table, and ``--write`` puts it into
docs/explanation/visual-thermal.md. The thermal frame of each scene is seen through a similarity whose corners
are then moved. "Off" is the mean distance from that homography over the pixels that both frames see, the
scene's own misalignment included; "apart" is how far that answer lies from the same scene's answer without
the motion, carried along by it: the registration's own error, without any ground truth.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from benchmarks.cases import Scene, apart, frame, kept, real, scenes, seen
from benchmarks.made import ROOT, put, table
from scipy import ndimage

from regframe import register
from regframe.geometry import Grid
from regframe.image import Image
from regframe.transforms.linear import turn
from regframe.types import Matrix, Points

PAGE = ROOT / "docs" / "explanation" / "visual-thermal.md"
KEPT = 0.8
"""Share of the frames, so that the other camera has something to see."""
ANGLE_DEG, LOG_SCALE, SHIFT = 2.0, 0.03, 0.03
CORNERS = 0.008
"""Of the width: standard deviation of what each corner moves beyond the similarity."""
PROJECTIVE: Mapping[str, object] = {
    "extends": "visual-thermal-projective",
    "name": "always",
    "stages.1.proof": None,
}
METHODS: Mapping[str, Mapping[str, object]] = {
    "`visual-thermal`": {"extends": "visual-thermal", "name": "similarity"},
    "`visual-thermal-projective`": PROJECTIVE,
    "the same, linear": {**PROJECTIVE, "stages.1.interpolator": "linear"},
}


@dataclass(frozen=True, eq=False)
class Moved:
    """A scene's frames, the thermal one moved and as it was, and points of the first with their places."""

    fixed: Image
    moving: Image
    still: Image
    seen: Points
    truth: Matrix  # from the still thermal frame to the moved one


def seen_through(matrix: Matrix, points: Points) -> Points:
    """Points under a homography."""
    lifted = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    return np.asarray(lifted[:, :2] / lifted[:, 2:])


def through(points: Points, reached: Points) -> Matrix:
    """The homography that takes four points to four others."""
    rows = []
    for (x, y), (u, v) in zip(points, reached, strict=True):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y], [0, 0, 0, x, y, 1, -v * x, -v * y]]
    return np.append(np.linalg.solve(np.array(rows), reached.ravel()), 1.0).reshape(3, 3)


def drawn(grid: Grid, rng: np.random.Generator) -> Matrix:
    """From the moved frame to the still one."""
    width, corners = grid.shape[1], grid.corners()
    turned = np.exp(rng.uniform(-LOG_SCALE, LOG_SCALE)) * turn(np.deg2rad(rng.uniform(-ANGLE_DEG, ANGLE_DEG)))
    shift = rng.uniform(-SHIFT, SHIFT, 2) + rng.normal(0.0, CORNERS, (4, 2))
    return through(corners, (corners - grid.centre) @ turned.T + grid.centre + shift * width)


def moved(scene: Scene, rng: np.random.Generator) -> Moved:
    """The middle of a scene, its thermal frame seen through a homography that is drawn."""
    grid, first = kept(scene, KEPT)
    while True:
        back = drawn(grid, rng)
        places = seen_through(back, grid.points(grid.all_indices())) + first[::-1]
        if places.min() >= 0.0 and np.all(places <= np.array(scene.thermal.shape[::-1]) - 1.0):
            break
    thermal = ndimage.map_coordinates(scene.thermal, places[:, ::-1].T, order=3, mode="nearest")
    rows, columns = (slice(at, at + n) for at, n in zip(first, grid.shape, strict=True))
    truth = np.asarray(np.linalg.inv(back), np.float64)
    return Moved(
        frame(scene.visual[rows, columns], "visual"),
        frame(thermal.reshape(grid.shape), "thermal"),
        frame(scene.thermal[rows, columns], "still"),
        seen(grid, grid, partial(seen_through, truth)),
        truth,
    )


def measured(most: int | None) -> Iterator[list[str]]:
    """A line of heads, and one for each method."""
    cases = [moved(scene, np.random.default_rng(number)) for number, scene in enumerate(scenes(most))]
    yield ["preset", "off: median, px", "off: most, px", "worst loss, px", "apart: median, px"]
    similar: list[float] = []
    for name, preset in METHODS.items():
        off, repeats = [], []
        for case in cases:
            found = register(preset, case.fixed, case.moving).warp(case.seen)
            still = register(preset, case.fixed, case.still).warp(case.seen)
            off.append(apart(found, seen_through(case.truth, case.seen)))
            repeats.append(apart(found, seen_through(case.truth, still)))
        similar = similar or off
        loss = max(one - other for one, other in zip(off, similar, strict=True))
        figures = (np.median(off), max(off), loss, np.median(repeats))
        yield [name, *(f"{figure:.2f}" for figure in figures)]


def main(arguments: list[str] | None = None) -> None:
    """Measure, and print or write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, help="no more than so many")
    parser.add_argument("--write", action="store_true", help=f"into {PAGE.name}")
    asked = parser.parse_args(arguments)
    text = table(measured(asked.scenes)) + "\n"
    sys.stdout.write(f"{'real scenes (RoadScene)' if real() else 'phantoms'}:\n\n{text}")
    if asked.write:
        put(PAGE, "homographies", text)


if __name__ == "__main__":
    main()
