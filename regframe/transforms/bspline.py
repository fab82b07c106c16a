"""Free-form deformation: y = x + sum of B-splines times coefficients."""

from dataclasses import replace
from typing import ClassVar, Literal, final

import numpy as np
from pydantic import Field

from regframe.geometry import AffineMap, Frame, Grid
from regframe.kernels import lattice as kernels
from regframe.kernels.sharing import BLOCKS, share
from regframe.transforms.base import Transform
from regframe.transforms.lattice import lattice, refined, refit
from regframe.types import Bins, Indices, Params, Points, Values


@final
class BSpline(Transform):
    """Displacement by splines on a lattice of control points laid over the fixed image.

    D. Rueckert, L. Sonoda, C. Hayes, D. Hill, M. Leach and D. Hawkes, "Nonrigid registration using
    free-form deformations: application to breast MR images", IEEE Trans. Medical Imaging 18(8), 1999;
    `itk::BSplineTransform` on the domain of its `BSplineTransformInitializer`. Parameters are the
    coefficients of the motion along x on all control points, x fastest, then along y (, z). Points beyond
    the image do not move. An affine start is taken over exactly within the image. A level's `refine` lays
    the lattice anew, as ITK does from level to level: over the pixels' centres, from the first point of
    the level's grid on, so that the outermost pixels may not move; the new control points keep the motion
    that was found at them.
    """

    closed: ClassVar[bool] = False
    refines: ClassVar[bool] = True

    mesh: tuple[int, ...] = Field(
        (4,),
        min_length=1,
        max_length=3,
        description="Cells along each axis, x first; one number counts for all axes.",
    )
    order: Literal[2, 3] = Field(3, description="Degree of the splines.")

    def identity(self, frame: Frame) -> Params:
        """No displacement."""
        return np.zeros(frame.dim * self._control(frame).size)

    def names(self, frame: Frame) -> tuple[str, ...]:
        """The direction of motion and the control point, x first."""
        shape = self._control(frame).shape
        points = [",".join(map(str, reversed(place))) for place in np.ndindex(shape)]
        return tuple(f"{axis}[{point}]" for axis in "xyz"[: frame.dim] for point in points)

    def map(self, params: Params, points: Points, frame: Frame) -> Points:
        """Moving points of (n, dim) fixed points, physical, x first."""
        moved = np.array(points, np.float64)
        shape, indices = self._placed(points, frame)
        share(kernels.displace, len(points), params, shape, self.order, indices, moved)
        return moved

    def parameter_gradient(self, params: Params, points: Points, forces: Points, frame: Frame) -> Params:
        """Sum over points of ``forces . d map / d params``, (p,): each point reaches its support alone."""
        shape, indices = self._placed(points, frame)
        partial = np.zeros((BLOCKS, len(params)))
        pulls = np.ascontiguousarray(forces, np.float64)
        share(kernels.scatter, BLOCKS, shape, self.order, indices, pulls, partial)
        total: Params = partial[0]
        for block in partial[1:]:
            total = total + block
        return total

    def shift(self, params: Params, frame: Frame) -> Params:
        """Largest motion over the grid's points per unit of each parameter, (p,)."""
        control = self._control(frame)
        reach = np.ones(())
        for axis, length in enumerate(control.shape):
            along = np.zeros(length)
            places = _places(frame.grid, control, axis)
            kernels.spread(0, len(places), self.order, places, along)
            reach = np.multiply.outer(reach, along)
        return np.tile(reach.ravel(), frame.dim)

    def from_affine(self, affine: AffineMap, frame: Frame) -> Params:
        """The affine map within the image: splines reproduce linear functions of their control points."""
        control = self._control(frame)
        points = control.points(control.all_indices())
        return np.asarray(affine(points) - points).T.ravel()

    def adapted(self, params: Params, frame: Frame, grid: Grid, refine: int | None) -> tuple[Params, Frame]:
        """Coefficients of the same motion on the lattice of a level that refines it."""
        if refine is None:
            return params, frame
        old, new = self._control(frame), refined(frame.grid, grid, (self.mesh, self.order, refine))
        if new == old:
            return params, frame
        places = old.indices(new.points(new.all_indices()))
        moved = [refit(one, places, new.shape, self.order) for one in params.reshape(frame.dim, *old.shape)]
        return np.concatenate(moved), replace(frame, lattice=new)

    def _control(self, frame: Frame) -> Grid:
        return frame.lattice or lattice(frame.grid, self.mesh, self.order)

    def _placed(self, points: Points, frame: Frame) -> tuple[Bins, Indices]:
        """The lattice's shape, (3,), and (n, 3) indices in it."""
        control = self._control(frame)
        indices = control.indices(points)
        if frame.dim == 2:
            indices = np.column_stack([np.zeros(len(indices)), indices])
        return np.array((1, *control.shape)[-3:], np.int64), np.ascontiguousarray(indices)


def _places(grid: Grid, control: Grid, axis: int) -> Values:
    """Where along one axis of the lattice the grid's points lie: both have the same axes, in some order."""
    lines = []
    for along, length in enumerate(grid.shape):
        line = np.zeros((length, grid.dim))
        line[:, along] = np.arange(length)
        lines.append(control.indices(grid.points(line))[:, axis])
    return np.ascontiguousarray(max(lines, key=np.ptp))
