"""Homographies of the plane about a centre: y = M (x - c) / (1 + s . (x - c)) + c + t."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from regframe.errors import GeometryError
from regframe.geometry import Grid
from regframe.kernels import homography as kernels
from regframe.kernels.planar import FAR
from regframe.kernels.sharing import BLOCKS, share
from regframe.types import Matrix, Params, Points

LEAST = 1e-6
"""Depth below which a point counts as on or beyond the horizon."""


STEP = 1e-5
"""Change of a parameter by which motions are measured."""


@dataclass(frozen=True, eq=False)
class Homography:
    """A homography by what it does at a centre, which it takes to ``centre + translation``.

    Any homography that has the centre before its horizon can be written so, in one way.

    Parameters
    ----------
    matrix : (2, 2) float64
        Its derivative at the centre.
    translation : (2,) float64
        Motion of the centre.
    slant : (2,) float64, per mm
        Growth of the depth along x and y; 0 for an affine map.
    centre : (2,) float64
    """

    matrix: Matrix
    translation: Params
    slant: Params
    centre: Params

    @classmethod
    def of_homogeneous(cls, whole: Matrix, centre: Params) -> "Homography":
        """Read a (3, 3) matrix whose points before the horizon have a positive third component.

        Raises
        ------
        GeometryError
            The centre lies on or beyond the horizon.
        """
        there, back = np.eye(3), np.eye(3)
        there[:2, 2], back[:2, 2] = centre, -centre
        about = back @ whole @ there
        if not about[2, 2] > LEAST * float(np.abs(whole[2]).max()):
            message = (
                f"This homography puts the centre {centre.tolist()} on or beyond its horizon: depth "
                f"{about[2, 2]:.3g}. Check the perspective of the matrix {np.asarray(whole).tolist()}."
            )
            raise GeometryError(message)
        about = about / about[2, 2]
        translation, slant = about[:2, 2], about[2, :2]
        return cls(about[:2, :2] - np.outer(translation, slant), translation, slant, centre)

    def place(self, points: Points) -> Points:
        """Where (n, 2) points go; `kernels.planar.FAR` where there is no image."""
        return places(kernels.place, self._numbers(), points)

    def pull(self, points: Points, forces: Points) -> Params:
        """Sum of ``forces . d place / d params``, (8,): matrix, translation, slant."""
        return pulls(kernels.pull, self._numbers(), points, forces, 8)

    def _numbers(self) -> Params:
        return np.concatenate([self.matrix.ravel(), self.translation, self.slant, self.centre])

    def homogeneous(self) -> Matrix:
        """The (3, 3) matrix, scaled to depth 1 at the centre."""
        there, back, about = np.eye(3), np.eye(3), np.eye(3)
        there[:2, 2], back[:2, 2] = self.centre, -self.centre
        about[:2, :2] = self.matrix + np.outer(self.translation, self.slant)
        about[:2, 2], about[2, :2] = self.translation, self.slant
        return np.asarray(there @ about @ back, np.float64)


def places(kernel: Callable[..., object], numbers: Params, points: Points) -> Points:
    """Where a kernel's `place` with its numbers puts (n, 2) points."""
    given = np.ascontiguousarray(points, np.float64)
    out = np.empty_like(given)
    share(kernel, len(given), numbers, given, out)
    return out


def pulls(
    kernel: Callable[..., object], numbers: Params, points: Points, forces: Points, count: int
) -> Params:
    """A kernel's `pull` of (n, 2) forces at points, `count` sums, its blocks added in order."""
    partial = np.zeros((BLOCKS, count))
    given = (np.ascontiguousarray(one, np.float64) for one in (points, forces))
    share(kernel, BLOCKS, numbers, *given, partial)
    total: Params = partial[0]
    for block in partial[1:]:
        total = total + block
    return total


def inverted(whole: Matrix) -> Matrix:
    """The inverse of a homogeneous matrix, the sign of its depth kept; a singular one raises GeometryError.

    Examples
    --------
    >>> inverted(np.diag([2.0, 4.0, 1.0])).diagonal().tolist()
    [0.5, 0.25, 1.0]
    """
    scaled = whole / np.maximum(np.abs(whole).max(axis=1, keepdims=True), np.finfo(np.float64).tiny)
    if abs(np.linalg.det(scaled)) < 1e-12:
        message = f"This homography cannot be inverted: its matrix {whole.tolist()} is singular."
        raise GeometryError(message)
    return np.asarray(np.linalg.inv(whole), np.float64)


def largest_motions(
    place: Callable[[Params, Points], Points], params: Params, points: Points, moving: Grid | None
) -> Params:
    """Largest motion of some points per unit of each parameter, (p,).

    Points without an image do not count; and where the moving image is known, only those that land in it
    do, if any: a lens or a perspective moves places far outside, which nobody sees, many times as far.

    Parameters
    ----------
    place : callable
        Where points go under given parameters, (n, 2).
    points : (n, 2) float64
    moving : Grid or None
    """
    here, found = place(params, points), np.zeros_like(params)
    if moving is not None:
        seen = moving.inside(moving.indices(here))
        if seen.any():
            points, here = points[seen], here[seen]
    for i in range(len(params)):
        moved = params.copy()
        moved[i] += STEP
        there = place(moved, points)
        near = (np.abs(here).max(axis=1) < FAR) & (np.abs(there).max(axis=1) < FAR)
        found[i] = np.sqrt(((there - here)[near] ** 2).sum(axis=1)).max(initial=0.0) / STEP
    return found


def net(grid: Grid, count: int = 9) -> Points:
    """Some of a grid's points, at most `count` an axis, corners included, (n, 2).

    Examples
    --------
    >>> net(Grid.of_shape((480, 640)), count=2).tolist()
    [[0.0, 0.0], [639.0, 0.0], [0.0, 479.0], [639.0, 479.0]]
    """
    lines = (np.unique(np.rint(np.linspace(0.0, n - 1.0, count))) for n in grid.shape)
    axes = np.meshgrid(*lines, indexing="ij")
    return grid.points(np.stack([axis.ravel() for axis in axes], axis=1))
