"""Where pixels lie in space: the only module that knows both xyz and zyx.

Points are physical and x first. Indices are continuous and in array order, so ``indices[:, -1]`` runs
along x. Sums follow ITK's order of operations, column by column without fused multiply-add, because
samples on a pixel border or intensities on a histogram edge are decided by the last bit.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product
from math import prod
from typing import Self

import numpy as np

from regframe.errors import GeometryError
from regframe.types import Indices, Mask, Matrix, Params, Points

Row = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class AffineMap:
    """The map ``v -> matrix @ v + offset``.

    Parameters
    ----------
    matrix : (dim, dim) float64
    offset : (dim,) float64

    Examples
    --------
    >>> turn = AffineMap(np.array([[0.0, -1.0], [1.0, 0.0]]), np.array([5.0, 0.0]))
    >>> (turn @ turn.inverse())(np.array([[3.0, 4.0]]))
    array([[3., 4.]])
    """

    matrix: Matrix
    offset: Params

    @classmethod
    def identity(cls, dim: int) -> Self:
        """The map that moves nothing, in `dim` dimensions."""
        return cls(np.eye(dim), np.zeros(dim))

    @classmethod
    def from_homogeneous(cls, matrix: Matrix) -> Self:
        """Read a (dim + 1, dim + 1) matrix whose last row is 0 ... 0 1."""
        return cls(np.array(matrix[:-1, :-1]), np.array(matrix[:-1, -1]))

    @property
    def dim(self) -> int:
        """Number of axes."""
        return len(self.offset)

    def __call__(self, points: Points) -> Points:
        """Map (n, dim) points."""
        total = self.matrix[:, 0] * points[:, :1]
        for column in range(1, self.dim):
            total = total + self.matrix[:, column] * points[:, column : column + 1]
        return total + self.offset

    def __matmul__(self, first: "AffineMap") -> "AffineMap":
        """Compose: ``(self @ first)(v) == self(first(v))``."""
        moved = self(first.offset[None])[0]
        return AffineMap(self.matrix @ first.matrix, moved)

    def inverse(self) -> "AffineMap":
        """The map back; a singular one raises GeometryError."""
        if abs(np.linalg.det(self.matrix)) < 1e-12 * max(1.0, np.abs(self.matrix).max() ** self.dim):
            message = (
                f"This map cannot be inverted: its matrix {self.matrix.tolist()} is singular. "
                "Check the scale and shear parameters it was built from."
            )
            raise GeometryError(message)
        matrix = np.linalg.inv(self.matrix)
        return AffineMap(np.asarray(matrix, np.float64), -(matrix @ self.offset))

    def reversed_axes(self) -> "AffineMap":
        """The same map written for the opposite order of axes (xyz against zyx)."""
        return AffineMap(
            np.ascontiguousarray(self.matrix[::-1, ::-1]), np.ascontiguousarray(self.offset[::-1])
        )

    def homogeneous(self) -> Matrix:
        """The (dim + 1, dim + 1) matrix with last row 0 ... 0 1."""
        whole = np.eye(self.dim + 1)
        whole[:-1, :-1] = self.matrix
        whole[:-1, -1] = self.offset
        return whole


@lru_cache(maxsize=64)
def _index_columns(spacing: Row, direction: tuple[Row, ...]) -> tuple[Row, ...]:
    """The matrix from physical offset to index offset, x first, with ITK's own bits."""
    dim = len(spacing)
    if direction == _identity_direction(dim):
        return tuple(tuple(1.0 / s if r == c else 0.0 for c in range(dim)) for r, s in enumerate(spacing))
    # ITK inverts oblique directions by an SVD of its own; asking it is the only way to get its last bit.
    import SimpleITK as sitk

    probe = sitk.Image([1] * dim, sitk.sitkUInt8)
    probe.SetSpacing(spacing)
    probe.SetDirection([v for row in direction for v in row])
    columns = [probe.TransformPhysicalPointToContinuousIndex(list(e)) for e in np.eye(dim)]
    return tuple(zip(*columns, strict=True))


def _identity_direction(dim: int) -> tuple[Row, ...]:
    return tuple(tuple(1.0 if r == c else 0.0 for c in range(dim)) for r in range(dim))


@dataclass(frozen=True)
class Grid:
    """A regular lattice of points: size, spacing, origin and direction, as in ITK.

    Parameters
    ----------
    shape : tuple of int
        Number of points an axis, array order (ny, nx) or (nz, ny, nx).
    spacing : tuple of float
        Distance between points an axis, x first; mm, or pixels for camera images.
    origin : tuple of float
        Position of the first point, x first.
    direction : tuple of tuple of float
        Rows of the matrix whose columns are the axis directions.

    Examples
    --------
    >>> grid = Grid.of_shape((480, 640))
    >>> grid.centre
    array([319.5, 239.5])
    """

    shape: tuple[int, ...]
    spacing: Row
    origin: Row
    direction: tuple[Row, ...]

    @classmethod
    def of_shape(cls, shape: Sequence[int]) -> Self:
        """A camera's grid: pixel units, spacing 1, origin at the centre of the first pixel."""
        dim = len(shape)
        return cls(tuple(map(int, shape)), (1.0,) * dim, (0.0,) * dim, _identity_direction(dim))

    @property
    def dim(self) -> int:
        """Number of axes."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """Number of points."""
        return prod(self.shape)

    @property
    def upright(self) -> bool:
        """Whether axes run along x, y (and z)."""
        return self.direction == _identity_direction(self.dim)

    @cached_property
    def index_to_point(self) -> AffineMap:
        """From index, x first, to point."""
        return AffineMap(np.array(self.direction) * np.array(self.spacing), np.array(self.origin))

    @cached_property
    def point_to_index(self) -> AffineMap:
        """From point to index, x first."""
        matrix = np.array(_index_columns(self.spacing, self.direction))
        # `0.0 -` rather than unary minus, so that a zero origin gives 0.0 and not -0.0.
        return AffineMap(matrix, 0.0 - matrix @ np.array(self.origin))

    def points(self, indices: Indices) -> Points:
        """Points of (n, dim) continuous indices, array order."""
        scaled = self.index_to_point.matrix
        total = np.broadcast_to(np.array(self.origin), indices.shape)
        for column in range(self.dim):
            axis = self.dim - 1 - column
            total = total + scaled[:, column] * indices[:, axis : axis + 1]
        return np.ascontiguousarray(total)

    def indices(self, points: Points) -> Indices:
        """Continuous indices, array order, of (n, dim) points."""
        matrix, found = self.point_to_index.matrix, np.empty(points.shape)
        # Axis by axis: numpy is several times as slow where its innermost loop is over two or three numbers.
        offsets = [points[:, column] - self.origin[column] for column in range(self.dim)]
        for row in range(self.dim):
            total = matrix[row, 0] * offsets[0]
            for column in range(1, self.dim):
                total += matrix[row, column] * offsets[column]
            found[:, self.dim - 1 - row] = total
        return found

    def inside(self, indices: Indices) -> Mask:
        """Which of (n, dim) indices lie in the grid's pixels: -0.5 <= index < n - 0.5."""
        return np.asarray(np.all((indices >= -0.5) & (indices < np.array(self.shape) - 0.5), axis=1))

    def all_indices(self) -> Indices:
        """Index of every grid point, (size, dim), x fastest."""
        return np.indices(self.shape, dtype=np.float64).reshape(self.dim, -1).T.copy()

    def corner_indices(self) -> Indices:
        """Indices of the 2**dim corner points."""
        return np.array(list(product(*((0.0, n - 1.0) for n in self.shape))))

    def corners(self) -> Points:
        """The 2**dim corner points, physical."""
        return self.points(self.corner_indices())

    @cached_property
    def centre(self) -> Params:
        """The physical centre."""
        middle: Params = self.points((np.array(self.shape)[None] - 1) / 2)[0]
        return middle

    @property
    def extent(self) -> Params:
        """Length of each axis, outer pixel edges, x first."""
        return np.asarray(np.array(self.spacing) * np.array(self.shape[::-1]), np.float64)

    @cached_property
    def radius(self) -> float:
        """Half the diagonal between outer pixel edges."""
        return float(np.linalg.norm(self.extent)) / 2

    def coarsen(self, factor: int) -> "Grid":
        """The grid with `factor` times the spacing and the same physical centre, at least 1 point an axis."""
        if factor == 1:
            return self
        shape = tuple(max(n // factor, 1) for n in self.shape)
        spacing = tuple(factor * s for s in self.spacing)
        coarse = Grid(shape, spacing, self.origin, self.direction)
        # ITK's order: the difference of two centres, each with the origin added last.
        shift = self._middle() - coarse._middle()
        origin = np.array(self.origin) + shift
        return Grid(shape, spacing, tuple(map(float, origin)), self.direction)

    def _middle(self) -> Params:
        """The physical centre, summed as ITK sums a continuous index."""
        scaled, middle = self.index_to_point.matrix, (np.array(self.shape[::-1]) - 1) / 2
        total = scaled[:, 0] * middle[0]
        for column in range(1, self.dim):
            total = total + scaled[:, column] * middle[column]
        return np.asarray(total + np.array(self.origin), np.float64)


@dataclass(frozen=True, eq=False)
class Frame:
    """What a transform may know of the images: the fixed grid and the centre it turns about.

    Parameters
    ----------
    grid : Grid
        The fixed image's grid; distances and default scales are measured over its corners.
    centre : (dim,) float64
        Fixed point of rotation, scaling and shear, physical, x first.
    lattice : Grid, optional
        Where a map's control points or vectors lie, for families that have them, when it is not where they
        lay them over the grid: a file has its own, and levels may refine it.
    moving : Grid, optional
        The moving image's grid, for transforms that speak of its lens.
    """

    grid: Grid
    centre: Params
    lattice: Grid | None = None
    moving: Grid | None = None

    @property
    def dim(self) -> int:
        """Number of axes."""
        return self.grid.dim

    @classmethod
    def about_centre(cls, grid: Grid, moving: Grid | None = None) -> Self:
        """The frame whose centre is the grid's own."""
        return cls(grid, grid.centre, moving=moving)

    def swapped(self) -> "Frame":
        """The frame of the way back, about the moving grid's centre; the same where that is not known."""
        return self if self.moving is None else Frame(self.moving, self.moving.centre, moving=self.grid)
