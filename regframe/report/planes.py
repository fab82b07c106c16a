"""Both images on one flat grid, ready to be looked at."""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from regframe.engine.base import Result
from regframe.engine.resampling import resample
from regframe.geometry import AffineMap, Frame, Grid
from regframe.image import Image
from regframe.transforms.warp import Chain, Warp
from regframe.types import Mask

PLANE = 2  # axes of a flat image
MOST_PIXELS = 4_000_000
SMALLEST_PANEL = 320
GREY_SAMPLES = 100_000

Shades = NDArray[np.float32]
"""(ny, nx), 0 for black to 1 for white."""


@dataclass(frozen=True, eq=False)
class Plane:
    """One flat view of a pair.

    Parameters
    ----------
    fixed, moving : (ny, nx) float32, 0 black to 1 white
        The moving image as the warp brings it here.
    inside : (ny, nx) bool
        Where there is a moving image.
    """

    fixed: Shades
    moving: Shades
    inside: Mask


def planes(result: Result, warp: Warp | Chain | None = None) -> list[Plane]:
    """The whole image in 2-D, the three middle slices in 3-D, contrast stretched.

    Parameters
    ----------
    result : Result
    warp : Warp or Chain, optional
        Another map than the result's own, for instance the one it started from.
    """
    fixed, moving = result.fixed, result.moving
    way, there = result.preset.stages[-1].interpolator, warp or result.warp
    stay = Warp.of_affine(AffineMap.identity(fixed.dim), Frame.about_centre(fixed.grid))
    fixed_tone, moving_tone = tone(fixed), tone(moving)
    found = []
    for grid, shape in views(fixed.grid):
        same = grid == fixed.grid
        below = fixed.values if same else resample(fixed.values, fixed.grid, grid, stay, way)[0]
        above, inside = resample(moving.values, moving.grid, grid, there, way)
        shades = fixed_tone(below).reshape(shape), moving_tone(above).reshape(shape)
        found.append(Plane(*shades, inside.reshape(shape)))
    return found


def tone(image: Image) -> Callable[[NDArray[np.floating]], Shades]:
    """From an image's values to shades: robust stretch, dark pictures brightened.

    The darkest and brightest hundredth are cut off. A gamma between 0.5 and 1 lifts the mean of night
    frames, whose few lamps would otherwise leave the rest black.
    """
    counted = image.values if image.mask is None else image.values[image.mask]
    drawn = counted.ravel()[:: max(1, counted.size // GREY_SAMPLES)]
    low, high = (float(edge) for edge in np.percentile(drawn, (1, 99)))
    if low == high:
        low, high = float(counted.min()), float(counted.max())
    width = high - low or 1.0
    mean = float(np.clip((drawn - low) / width, 0, 1).mean())
    gamma = float(np.clip(np.log(0.4) / np.log(mean), 0.5, 1.0)) if 0 < mean < 1 else 1.0

    def shades(values: NDArray[np.floating]) -> Shades:
        flat = np.asarray(np.clip((values - np.float32(low)) / np.float32(width), 0, 1), np.float32)
        return flat if gamma == 1.0 else np.asarray(flat ** np.float32(gamma), np.float32)

    return shades


def views(grid: Grid) -> list[tuple[Grid, tuple[int, int]]]:
    """Grids of square pixels to look at a grid by, and the flat shape of each.

    A 2-D grid is seen along its own axes. A 3-D one is cut through its centre across the physical axes:
    axial (x right, y down), coronal (x right, z up), sagittal (y right, z up), which for images in ITK's
    coordinates are a radiologist's usual views.
    """
    return [_own(grid)] if grid.dim == PLANE else _cuts(grid)


def _own(grid: Grid) -> tuple[Grid, tuple[int, int]]:
    x, y = grid.spacing
    step = min(x, y)
    shape = (max(1, round(grid.shape[0] * y / step)), max(1, round(grid.shape[1] * x / step)))
    coarse = max(1, ceil(sqrt(shape[0] * shape[1] / MOST_PIXELS)))
    if x == y and coarse == 1:
        return grid, shape
    square = Grid((*shape,), (step, step), grid.origin, grid.direction).coarsen(coarse)
    return square, (square.shape[0], square.shape[1])


def _cuts(grid: Grid) -> list[tuple[Grid, tuple[int, int]]]:
    corners = grid.corners()
    low, high = corners.min(axis=0), corners.max(axis=0)
    step = min(*grid.spacing, float((high - low).max()) / SMALLEST_PANEL) or 1.0
    nx, ny, nz = (int((top - bottom) / step) + 1 for bottom, top in zip(low, high, strict=True))
    middle = (low + high) / 2
    down = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0))
    spacing = (step,) * 3

    def cut(shape: tuple[int, int, int], axis: int) -> Grid:
        origin = np.array([low[0], low[1], high[2]])
        origin[axis] = middle[axis]
        return Grid(shape, spacing, tuple(map(float, origin)), down)

    return [
        (cut((1, ny, nx), 2), (ny, nx)),
        (cut((nz, 1, nx), 1), (nz, nx)),
        (cut((nz, ny, 1), 0), (nz, ny)),
    ]
