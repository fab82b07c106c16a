"""The lattice of control points that ITK lays over an image."""

from functools import lru_cache
from itertools import product

import numpy as np

from regframe.errors import GeometryError
from regframe.geometry import AffineMap, Grid
from regframe.kernels import spline
from regframe.kernels.sharing import share
from regframe.types import Indices, Matrix, Params, Points, Values, Volume

_RIM = 0.125
"""Pixels that the lattice's domain reaches beyond the image's outer edges."""


@lru_cache(maxsize=16)
def lattice(grid: Grid, mesh: tuple[int, ...], order: int) -> Grid:
    """Control points for a mesh of cells over a grid, as `BSplineTransformInitializer` lays them.

    Axes follow the physical ones as well as the grid's direction allows, from the corner nearest to the
    bounding box's lower end. ITK computes corners and directions in single precision, and so does this.

    Parameters
    ----------
    mesh : tuple of int
        Number of cells along each axis of the lattice, x first; one number counts for all.

    Raises
    ------
    GeometryError
        As many numbers as there are no axes.
    """
    if len(mesh) not in (1, grid.dim):
        message = (
            f"`mesh` has {len(mesh)} numbers and the image {grid.dim} axes. "
            "Give one number an axis, or one for all."
        )
        raise GeometryError(message)
    cells = np.array(_every(mesh, grid.dim))
    origin, edges = _domain(grid)
    lengths = np.sqrt((edges**2).sum(axis=1))
    direction = (edges / lengths[:, None]).astype(np.float32).astype(np.float64).T
    spacing = lengths / cells
    first = origin - direction @ (spacing * (order - 1) * 0.5)
    shape = tuple(int(n) + order for n in cells[::-1])
    rows = tuple(tuple(map(float, row)) for row in direction)
    return Grid(shape, tuple(map(float, spacing)), tuple(map(float, first)), rows)


def refined(fixed: Grid, level: Grid, how: tuple[tuple[int, ...], int, int]) -> Grid:
    """Control points as ITK lays them anew before a level of a registration.

    The mesh covers as much as lies between the centres of the fixed grid's outer points, but it begins at
    the first point of the level's grid, which lies further in when that is shrunk: ITK's choice.

    Parameters
    ----------
    fixed, level : Grid
        The fixed grid, and the level's shrunk one.
    how : (mesh, order, factor)
        Cells along each axis, degree, and by how much the cells are divided.
    """
    mesh, order, factor = how
    cells = np.array(_every(mesh, fixed.dim)) * factor
    spacing = np.array(fixed.spacing) * (np.array(fixed.shape[::-1]) - 1) / cells
    # ITK's order of sums: the outermost samples lie on the end of the splines, and the last bit decides.
    inward = AffineMap(np.array(level.direction), np.array(level.origin))
    first = inward((-0.5 * spacing * (order - 1))[None])[0]
    shape = tuple(int(n) + order for n in cells[::-1])
    return Grid(shape, tuple(map(float, spacing)), tuple(map(float, first)), level.direction)


def refit(coefficients: Volume, places: Indices, shape: tuple[int, ...], order: int) -> Values:
    """Coefficients on a new lattice of the motion that others describe.

    The motion is read as a cubic spline, mirrored at the ends of its lattice, and is 0 outside: ITK's way,
    also for splines of order 2.

    Parameters
    ----------
    coefficients : volume
        One direction's.
    places : (n, dim) float64
        The new control points as indices of the old lattice, array order.
    shape : tuple of int
        The new lattice's.

    Returns
    -------
    (n,) float64
    """
    dim = coefficients.ndim
    values, weights = np.empty(len(places)), np.empty(len(places))
    volume = np.ascontiguousarray(coefficients).reshape((1,) * (3 - dim) + coefficients.shape)
    at = np.zeros((len(places), 3))
    at[:, 3 - dim :] = places
    grid, rows = np.ones(3, np.int64), -(-len(places) // spline.RUN)
    share(spline.resample, rows, volume, 3, grid, at, np.eye(3, 4), values, weights)
    return spline.prefilter((values * weights).reshape(shape), order).ravel()


def _every(mesh: tuple[int, ...], dim: int) -> tuple[int, ...]:
    return mesh * dim if len(mesh) == 1 else mesh


def _domain(grid: Grid) -> tuple[Params, Matrix]:
    """The domain's first corner, and the edges from it, one a row, in the order of the physical axes."""
    corners = _corners(grid)
    lowest = corners.min(axis=0)
    begin = int(np.argmin(((corners - lowest) ** 2).sum(axis=1)))
    edges = [
        (corners[begin ^ (1 << axis)].astype(np.float32) - corners[begin].astype(np.float32))
        for axis in range(grid.dim)
    ]
    free, chosen = list(range(grid.dim)), []
    for axis in range(grid.dim):
        nearest = max(free, key=lambda one: edges[one][axis] / np.linalg.norm(edges[one]))
        free.remove(nearest)
        chosen.append(edges[nearest].astype(np.float64))
    return corners[begin], np.array(chosen)


def _corners(grid: Grid) -> Points:
    """The 2**dim corners in single precision; bit k of a corner's number is its end along axis k, x first."""
    ends = [(-0.5 - _RIM, n - 0.5 + _RIM) for n in grid.shape]
    exact = grid.points(np.array(list(product(*ends))))
    return exact.astype(np.float32).astype(np.float64)
