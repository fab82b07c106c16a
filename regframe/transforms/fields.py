"""Any warp as a displacement field, for programs that know no other form of it."""

import numpy as np
from numpy.typing import NDArray

from regframe.geometry import Grid
from regframe.kernels.planar import LOST
from regframe.transforms.warp import Chain, Warp
from regframe.types import Params, Points

COARSEST = 16  # pixels between the field's nodes
PRECISION = 0.01  # pixels
OUTSIDE = 1e6  # mm: how far a point without an image is moved


def displacement_field(warp: Warp | Chain) -> tuple[Grid, Points]:
    """The warp's displacements on a grid over the fixed image, as coarse as `PRECISION` allows.

    Between nodes the field is linear; nodes lie as far apart as keeps the error in the middles of all cells
    below a hundredth of a pixel, at most `COARSEST` pixels and at least one. A point without an image, such
    as one beyond the horizon of a homography, is moved far away, and so is the cell that it bounds.

    Returns
    -------
    grid : Grid
        Its corners are those of the fixed grid.
    displacements : (n, dim) float64, mm, x first
        Of the grid's points, x fastest.
    """
    fixed, step = warp.frame.grid, COARSEST
    while True:
        grid = _coarse(fixed, step)
        nodes = grid.points(grid.all_indices())
        moved = _displaced(warp, nodes)
        if step == 1 or _error(warp, grid, moved) < PRECISION * min(fixed.spacing):
            return grid, moved
        step //= 2


def _coarse(fixed: Grid, step: int) -> Grid:
    """A grid with the fixed grid's corners and nodes at most `step` pixels apart."""
    cells = [max(1, -(-(n - 1) // step)) for n in fixed.shape]
    shape = tuple(n + 1 for n in cells)
    width = zip(fixed.spacing, reversed(fixed.shape), reversed(cells), strict=True)
    return Grid(shape, tuple(s * (n - 1) / c for s, n, c in width), fixed.origin, fixed.direction)


def _displaced(warp: Warp | Chain, points: Points) -> Points:
    there = warp(points)
    lost = np.abs(there).max(axis=1) > LOST
    moved = there - points
    moved[lost] = OUTSIDE
    return np.asarray(moved)


def _error(warp: Warp | Chain, grid: Grid, moved: Points) -> float:
    """The largest error in the middle of a cell, of those whose corners all have an image."""
    whole = moved.reshape(*grid.shape, grid.dim)
    middle = _means(whole)
    counted = _means((np.abs(whole).max(axis=-1, keepdims=True) < OUTSIDE / 2).astype(np.float64)) == 1.0
    inner = np.indices([n - 1 for n in grid.shape], dtype=np.float64).reshape(grid.dim, -1).T + 0.5
    wanted = _displaced(warp, grid.points(inner)).reshape(middle.shape)
    far: Params = np.sqrt(((middle - wanted) ** 2).sum(axis=-1))
    return float(far[counted[..., 0]].max(initial=0.0))


def _means(nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean of the corners of every cell."""
    for axis in range(nodes.ndim - 1):
        ends = np.moveaxis(nodes, axis, 0)
        nodes = np.moveaxis((ends[:-1] + ends[1:]) / 2, 0, axis)
    return nodes
