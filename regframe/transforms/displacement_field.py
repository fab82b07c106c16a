"""A field of displacements: y = x + the vector at x."""

from dataclasses import replace
from typing import ClassVar, final

import numpy as np
from pydantic import Field

from regframe.geometry import AffineMap, Frame, Grid
from regframe.kernels import field as kernels
from regframe.kernels.discrete import window
from regframe.kernels.sharing import share
from regframe.transforms.base import Transform
from regframe.types import Bins, Indices, Params, Points, Volume

MISSING = 0.001  # share of a window's mass that ITK leaves off
WHOLE = 0.5  # variance from which on ITK takes the smoothed field alone


@final
class DisplacementField(Transform):
    """One vector a grid point, linear between them; points beyond the field do not move.

    `itk::DisplacementFieldTransform`, and where a variance is given
    `itk::GaussianSmoothingOnUpdateDisplacementFieldTransform`: after Stefanescu, Pennec and
    Ayache, "Grid powered nonlinear image registration with locally adaptive regularization", Medical Image
    Analysis 8(3), 2004, smoothing each step makes the motion fluid, and smoothing the whole field makes it
    elastic. Parameters are the vectors of all points, x fastest, components side by side. The field lies on
    each level's grid: a level begins with the field of the one before, read between its points. Nothing
    but smoothing ties neighbours together, so without it noise moves points. Scales and weights are one
    number an axis, and searches without slopes do not suit so many parameters.
    """

    local: ClassVar[bool] = True
    closed: ClassVar[bool] = False

    update_variance: float = Field(
        0.0,
        ge=0,
        allow_inf_nan=False,
        description="Variance, in points of the field squared, of the Gaussian on each step; ITK's is 1.75.",
    )
    total_variance: float = Field(
        0.0,
        ge=0,
        allow_inf_nan=False,
        description=(
            "The same on the whole field after each step; ITK's is 0.5. Where either is above 0, the border "
            "of the field does not move."
        ),
    )

    def identity(self, frame: Frame) -> Params:
        """No displacement."""
        return np.zeros(frame.dim * _points_of(frame).size)

    def names(self, frame: Frame) -> tuple[str, ...]:
        """The direction of motion and the point, x first."""
        points = [",".join(map(str, reversed(place))) for place in np.ndindex(_points_of(frame).shape)]
        return tuple(f"{axis}[{point}]" for point in points for axis in "xyz"[: frame.dim])

    def map(self, params: Params, points: Points, frame: Frame) -> Points:
        """Moving points of (n, dim) fixed points, physical, x first."""
        moved = np.array(points, np.float64)
        shape, indices = _placed(points, frame)
        share(kernels.displace, len(points), np.ascontiguousarray(params), shape, indices, moved)
        return moved

    def parameter_gradient(self, params: Params, points: Points, forces: Points, frame: Frame) -> Params:
        """Sum over points of ``forces . d map / d params``, (p,): a force goes to its neighbours."""
        total = np.zeros_like(params)
        shape, indices = _placed(points, frame)
        kernels.scatter(shape, indices, np.ascontiguousarray(forces, np.float64), total)
        return total

    def shift(self, params: Params, frame: Frame) -> Params:
        """Largest motion per unit of each parameter, (p,): of the field's own points."""
        return np.ones_like(params)

    def advance(self, params: Params, step: Params, frame: Frame) -> Params:
        """The sum, smoothed as ITK does: first the step, then the whole field."""
        if not step.any() or self.update_variance == self.total_variance == 0.0:
            return params + step
        shape = (*_points_of(frame).shape, frame.dim)
        moved = params.reshape(shape) + smoothed(step.reshape(shape), self.update_variance)
        return smoothed(moved, self.total_variance).ravel()

    def from_affine(self, affine: AffineMap, frame: Frame) -> Params:
        """The affine map within the field, exactly: it is linear between points."""
        grid = _points_of(frame)
        points = grid.points(grid.all_indices())
        return np.asarray(affine(points) - points).ravel()

    def adapted(self, params: Params, frame: Frame, grid: Grid, refine: int | None) -> tuple[Params, Frame]:
        """The same field read at the points of a level's grid, 0 beyond its ends."""
        if grid == _points_of(frame):
            return params, frame
        points = grid.points(grid.all_indices())
        moved = self.map(params, points, frame) - points
        return moved.ravel(), replace(frame, lattice=grid)


def smoothed(field: Volume, variance: float) -> Volume:
    """A field after the discrete Gaussian of a variance along each axis, its border held still.

    Below a variance of one half ITK mixes the smoothed field with the given one, the less of it the
    nearer the variance comes to one half; from there on it takes the smoothed one alone.

    Parameters
    ----------
    field : (ny, nx, 2) or (nz, ny, nx, 3) float64
    """
    from scipy.ndimage import correlate1d

    if variance == 0.0:
        return field
    found = field
    for axis in range(field.ndim - 2, -1, -1):
        half = window(variance, MISSING, field.shape[axis])
        taps = np.concatenate([half[:0:-1], half])
        found = correlate1d(found, taps, axis, mode="nearest")
    share_of_it = 1.0 - variance / WHOLE if variance < WHOLE else 1.0
    mixed = found * share_of_it + field * (1.0 - share_of_it)
    inner = (slice(1, -1),) * (field.ndim - 1)
    still = np.zeros_like(mixed)
    still[inner] = mixed[inner]
    return still


def _points_of(frame: Frame) -> Grid:
    return frame.lattice or frame.grid


def _placed(points: Points, frame: Frame) -> tuple[Bins, Indices]:
    """The field's shape, (3,), and (n, 3) indices in it."""
    grid = _points_of(frame)
    indices = grid.indices(points)
    if frame.dim == 2:
        indices = np.column_stack([np.zeros(len(indices)), indices])
    return np.array((1, *grid.shape)[-3:], np.int64), np.ascontiguousarray(indices)
