"""Pictures of two images laid over each other, as plain arrays of colour."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from regframe.engine.base import Result
from regframe.report.planes import Plane, Shades, planes
from regframe.report.png import Picture
from regframe.report.starts import first_warp

ABSENT = 0.45  # how bright the fixed image is where there is no moving one
TILES = 8
GAP = 6
PAPER = 255
ORANGE = np.array([230, 159, 0], np.float32) / 255
BLUE = np.array([0, 114, 178], np.float32) / 255


def overlays(result: Result) -> dict[str, Picture]:
    """Every overlay of a result, each an (ny, nx, 3) uint8 picture.

    Returns
    -------
    dict
        ``red-cyan``, ``difference``, ``checkerboard`` of the aligned pair, and ``before``: red-cyan at
        the map the search started from. In 3-D each shows the three middle slices side by side.
    """
    after = planes(result)
    before = planes(result, first_warp(result))
    return {
        "red-cyan": draw(after, red_cyan),
        "difference": draw(after, difference),
        "checkerboard": draw(after, checkerboard),
        "before": draw(before, red_cyan),
    }


def draw(views: Sequence[Plane], paint: Callable[[Plane], Picture]) -> Picture:
    """Paint each plane and set them side by side on white."""
    pictures = [paint(view) for view in views]
    if len(pictures) == 1:
        return pictures[0]
    height = max(len(picture) for picture in pictures)
    parts: list[Picture] = []
    for picture in pictures:
        panel = np.full((height, picture.shape[1], 3), PAPER, np.uint8)
        top = (height - len(picture)) // 2
        panel[top : top + len(picture)] = picture
        parts += [panel, np.full((height, GAP, 3), PAPER, np.uint8)]
    return np.concatenate(parts[:-1], axis=1)


def red_cyan(plane: Plane) -> Picture:
    """Fixed in red, moving in cyan: grey where they agree, coloured rims where they do not."""
    picture = _ground(plane)
    picture[..., 0] = np.where(plane.inside, plane.fixed, picture[..., 0])
    picture[..., 1] = picture[..., 2] = np.where(plane.inside, plane.moving, picture[..., 1])
    return _bytes(picture)


def difference(plane: Plane) -> Picture:
    """Orange where the fixed image is brighter, blue where the moving one is, white where equal.

    The palette keeps apart for every kind of colour vision.
    """
    gap = (plane.fixed - plane.moving)[..., None]
    picture = 1 - np.maximum(gap, 0) * (1 - ORANGE) - np.maximum(-gap, 0) * (1 - BLUE)
    return _bytes(np.where(plane.inside[..., None], picture, _ground(plane)))


def checkerboard(plane: Plane) -> Picture:
    """Tiles of the fixed and the moving image in turn: lines must run on across their borders."""
    side = max(4, round(min(plane.fixed.shape) / TILES))
    rows, columns = (np.arange(n) // side for n in plane.fixed.shape)
    other = ((rows[:, None] + columns) % 2 == 1) & plane.inside
    picture = _ground(plane)
    mixed = np.where(other, plane.moving, plane.fixed)
    return _bytes(np.where(plane.inside[..., None], mixed[..., None], picture))


def _ground(plane: Plane) -> NDArray[np.float32]:
    """The fixed image in dim grey, (ny, nx, 3)."""
    dim: Shades = plane.fixed * np.float32(ABSENT)
    return np.repeat(dim[..., None], 3, axis=2)


def _bytes(picture: NDArray[np.float32]) -> Picture:
    return np.clip(np.rint(picture * 255), 0, 255).astype(np.uint8)
