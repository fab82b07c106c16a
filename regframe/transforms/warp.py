"""Maps as values: a transform at particular parameters, and chains of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from operator import matmul

from regframe.errors import GeometryError
from regframe.geometry import AffineMap, Frame
from regframe.transforms.affine import Affine
from regframe.transforms.base import Transform
from regframe.types import Matrix, Params, Points


@dataclass(frozen=True, eq=False)
class Warp:
    """A transform at particular parameters: takes fixed points to moving points.

    Parameters
    ----------
    transform : Transform
    params : (p,) float64
    frame : Frame
        The fixed grid and the centre the parameters speak of.

    Examples
    --------
    >>> import numpy as np
    >>> from regframe.geometry import Frame, Grid
    >>> from regframe.transforms.similarity import Similarity
    >>> frame = Frame.about_centre(Grid.of_shape((11, 11)))
    >>> warp = Warp(Similarity(), np.array([2.0, 0.0, 1.0, 0.0]), frame)
    >>> warp(np.array([[5.0, 6.0]]))
    array([[6., 7.]])
    >>> (warp @ warp.inverse())(np.array([[3.0, 4.0]]))
    array([[3., 4.]])
    """

    transform: Transform
    params: Params
    frame: Frame

    @classmethod
    def of_affine(cls, affine: AffineMap, frame: Frame) -> "Warp":
        """The affine warp of a matrix and offset."""
        family = Affine()
        return cls(family, family.from_affine(affine, frame), frame)

    def __call__(self, points: Points) -> Points:
        """Moving points of (n, dim) fixed points, physical, x first."""
        return self.transform.map(self.params, points, self.frame)

    def __matmul__(self, first: "Warp | Chain") -> "Chain":
        """Compose: ``(self @ first)(x) == self(first(x))``."""
        return Chain((self, *first.warps)) if isinstance(first, Chain) else Chain((self, first))

    def pull(self, points: Points, forces: Points) -> Points:
        """Forces on mapped points as forces on the points themselves, (n, dim) both."""
        return self.transform.pull(self.params, points, forces, self.frame)

    def as_affine(self) -> AffineMap | None:
        """The map as a matrix and offset, or None where it is not affine."""
        return self.transform.as_affine(self.params, self.frame)

    def as_homogeneous(self) -> Matrix | None:
        """The map as a homogeneous matrix, or None where it bends straight lines."""
        return self.transform.as_homogeneous(self.params, self.frame)

    def inverse(self) -> "Warp":
        """The map from moving to fixed points, of the same family where that holds inverses.

        Raises
        ------
        GeometryError
            The map is singular, or of a family without inverses.
        """
        found = self.transform.inverse(self.params, self.frame)
        if found is not None:
            return Warp(*found)
        affine = self.as_affine()
        if affine is None:
            message = f"{type(self.transform).__name__} has no closed inverse. Invert an affine fit of it."
            raise GeometryError(message)
        if not self.transform.closed:
            return Warp.of_affine(affine.inverse(), self.frame)
        return Warp(self.transform, self.transform.from_affine(affine.inverse(), self.frame), self.frame)


@dataclass(frozen=True, eq=False)
class Chain:
    """Warps applied one after the other, the last one first, as in ITK's composite transform."""

    warps: tuple[Warp, ...]

    def __call__(self, points: Points) -> Points:
        """Moving points of (n, dim) fixed points, physical, x first."""
        for warp in reversed(self.warps):
            points = warp(points)
        return points

    def pull(self, points: Points, forces: Points) -> Points:
        """Forces on mapped points as forces on the points themselves, (n, dim) both."""
        met = [points]
        for warp in reversed(self.warps[1:]):
            met.append(warp(met[-1]))
        for warp, place in zip(self.warps, reversed(met), strict=True):
            forces = warp.pull(place, forces)
        return forces

    def __matmul__(self, first: "Warp | Chain") -> "Chain":
        """Compose: ``(self @ first)(x) == self(first(x))``."""
        return Chain((*self.warps, *(first.warps if isinstance(first, Chain) else (first,))))

    @property
    def frame(self) -> Frame:
        """The frame of the warp that meets the fixed points first."""
        return self.warps[-1].frame

    def as_affine(self) -> AffineMap | None:
        """The whole map as a matrix and offset, or None where a member is not affine."""
        affines = [warp.as_affine() for warp in self.warps]
        found = [affine for affine in affines if affine is not None]
        return reduce(matmul, found) if len(found) == len(affines) else None

    def as_homogeneous(self) -> Matrix | None:
        """The whole map as a homogeneous matrix, or None where a member bends straight lines."""
        members = [warp.as_homogeneous() for warp in self.warps]
        found = [matrix for matrix in members if matrix is not None]
        return reduce(matmul, found) if len(found) == len(members) else None

    def inverse(self) -> "Chain":
        """The map from moving to fixed points."""
        return Chain(tuple(warp.inverse() for warp in reversed(self.warps)))


def chain(warps: Sequence[Warp]) -> "Warp | Chain":
    """One warp as it is, several as a chain; the last one is applied first."""
    return warps[0] if len(warps) == 1 else Chain(tuple(warps))
