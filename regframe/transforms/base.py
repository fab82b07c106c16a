"""Families of maps from fixed to moving points."""

from abc import abstractmethod
from typing import ClassVar, TypeAlias

import numpy as np

from regframe.component import Component
from regframe.errors import GeometryError
from regframe.geometry import AffineMap, Frame, Grid
from regframe.types import Matrix, Params, Points

DIFFERENCE_STEP = 1e-6
PULL_STEP = 1e-4  # spacings of the grid

Inverse: TypeAlias = "tuple[Transform, Params, Frame]"


class Transform(Component):
    """A family of maps from fixed points to moving points, indexed by parameters.

    Parameters, their order and the centre are ITK's, so a warp crosses to SimpleITK without arithmetic.
    """

    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    local: ClassVar[bool] = False
    """Whether parameters are the motion of the points of a lattice, each one's components side by side.

    A stage's scales and weights are then one number an axis.
    """

    refines: ClassVar[bool] = False
    """Whether a level may `refine` its lattice."""

    closed: ClassVar[bool] = True
    """Whether the inverse of an affine member is a member; if not, a warp's inverse is plainly affine."""

    @abstractmethod
    def identity(self, frame: Frame) -> Params:
        """Parameters that move nothing."""

    @abstractmethod
    def map(self, params: Params, points: Points, frame: Frame) -> Points:
        """Moving points of (n, dim) fixed points, physical, x first."""

    def names(self, frame: Frame) -> tuple[str, ...]:
        """Hook: what each parameter is called in traces and reports; a unit where it has one."""
        return tuple(f"p{i}" for i in range(len(self.identity(frame))))

    def parameter_gradient(self, params: Params, points: Points, forces: Points, frame: Frame) -> Params:
        """Hook: sum over points of ``forces . d map / d params``, (p,).

        Parameters
        ----------
        points, forces : (n, dim) float64, physical, x first
        """
        steps = DIFFERENCE_STEP / self.shift(params, frame)
        total = np.empty_like(params)
        for i, step in enumerate(steps):
            ahead, behind = params.copy(), params.copy()
            ahead[i] += step
            behind[i] -= step
            slope = (self.map(ahead, points, frame) - self.map(behind, points, frame)) / (2 * step)
            total[i] = float(np.sum(forces * slope))
        return total

    def shift(self, params: Params, frame: Frame) -> Params:
        """Hook: largest motion over the grid's points per unit of each parameter, (p,).

        The default looks at the corners, where affine maps move most.
        """
        corners, step = frame.grid.corners(), 1e-4
        here = self.map(params, corners, frame)
        reach = np.empty_like(params)
        for i in range(len(params)):
            moved = params.copy()
            moved[i] += step
            there = self.map(moved, corners, frame)
            reach[i] = np.sqrt(((there - here) ** 2).sum(axis=1)).max() / step
        return reach

    def advance(self, params: Params, step: Params, frame: Frame) -> Params:
        """Hook: parameters after a gradient optimizer's step, (p,); the sum unless, say, rotations compose.

        A step of zeros brings parameters into the family's domain, where that has an end.
        """
        return params + step

    def adapted(self, params: Params, frame: Frame, grid: Grid, refine: int | None) -> tuple[Params, Frame]:
        """Hook: parameters and frame for a level whose samples lie on a grid; both as they are by default.

        Parameters
        ----------
        grid : Grid
            The level's, shrunk.
        refine : int or None
            What the level says of the transform's lattice.
        """
        return params, frame

    def pull(self, params: Params, points: Points, forces: Points, frame: Frame) -> Points:
        """Hook: forces on mapped points as forces on the points themselves, ``(d map / d point)^T force``.

        Parameters
        ----------
        points, forces : (n, dim) float64, physical, x first
            Points before the map, and forces on them behind it.
        """
        affine = self.as_affine(params, frame)
        if affine is not None:
            return np.asarray(forces @ affine.matrix)
        felt, step = np.empty_like(forces), PULL_STEP * min(frame.grid.spacing)
        for axis in range(frame.dim):
            ahead, behind = points.copy(), points.copy()
            ahead[:, axis] += step
            behind[:, axis] -= step
            slope = (self.map(params, ahead, frame) - self.map(params, behind, frame)) / (2 * step)
            felt[:, axis] = (forces * slope).sum(axis=1)
        return felt

    def as_affine(self, params: Params, frame: Frame) -> AffineMap | None:
        """Hook: the map as a matrix and offset, physical, or None; opens the fast path."""
        return None

    def as_homogeneous(self, params: Params, frame: Frame) -> Matrix | None:
        """Hook: the map as a homogeneous (dim + 1, dim + 1) matrix, or None where it bends straight lines.

        Points before the horizon have a positive last component. The default is that of `as_affine`.
        """
        affine = self.as_affine(params, frame)
        return None if affine is None else affine.homogeneous()

    def from_affine(self, affine: AffineMap, frame: Frame) -> Params:
        """Hook: parameters whose map is nearest to a given affine one; starts and stages use it.

        Raises
        ------
        GeometryError
            The family cannot be started from an affine map.
        """
        message = (
            f"{type(self).__name__} cannot start from a given affine map. Start it from the identity, "
            "or give it a `from_affine`."
        )
        raise GeometryError(message)

    def from_homogeneous(self, whole: Matrix, frame: Frame) -> Params:
        """Hook: parameters whose map is nearest to a homography; stages that follow `projective` use it.

        The default takes affine ones alone.

        Raises
        ------
        GeometryError
            The family holds no such map.
        """
        if np.any(whole[-1, :-1] != 0.0):
            message = (
                f"{type(self).__name__} cannot continue a homography. Put this stage first, or begin it with "
                "another `start`."
            )
            raise GeometryError(message)
        return self.from_affine(AffineMap.from_homogeneous(whole / whole[-1, -1]), frame)

    def inverse(self, params: Params, frame: Frame) -> "Inverse | None":
        """Hook: the map from moving to fixed points, a member of some family; None leaves it to `as_affine`.

        Raises
        ------
        GeometryError
            The map has no inverse.
        """
        return None
