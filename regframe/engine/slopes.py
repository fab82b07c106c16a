"""From slopes by intensity to slopes by parameter."""

from dataclasses import dataclass

import numpy as np

from regframe.engine.scene import Scene
from regframe.geometry import AffineMap, Frame, Grid
from regframe.image import Image
from regframe.interpolators.base import Samples
from regframe.interpolators.linear import Linear
from regframe.kernels.gaussian import gradient
from regframe.preset import Stage
from regframe.types import Indices, Matrix, Params, Points, Values, Volume


@dataclass(frozen=True, eq=False)
class ImageSlopes:
    """How steep an image is between its pixels, in the stage's way.

    Parameters
    ----------
    stage
    image : Image
        The level's.
    images : tuple of volumes
        ITK's gradient images along physical x, y (and z); empty in the other modes.
    """

    stage: Stage
    image: Image
    images: tuple[Volume, ...]

    @classmethod
    def of(cls, stage: Stage, image: Image) -> "ImageSlopes":
        """Prepared for one level."""
        images: tuple[Volume, ...] = ()
        if stage.gradient == "filtered":
            grid = image.grid
            slopes = gradient(
                image.values, max(grid.spacing), spacing=grid.spacing, direction=np.array(grid.direction)
            )
            images = tuple(slopes)
        return cls(stage, image, images)

    def at(self, indices: Indices, coefficients: Volume) -> Points:
        """Slopes along the physical axes, x first, at indices of the image, which has these coefficients."""
        grid = self.image.grid
        if self.stage.gradient == "filtered":
            at = Samples(grid.shape, np.clip(indices, 0.0, np.array(grid.shape) - 1.0))
            return np.column_stack([Linear().resample(image, at, None)[0] for image in self.images])
        if self.stage.gradient == "central":
            return _central(np.ascontiguousarray(self.image.values, np.float64), indices, grid)
        slopes = self.stage.interpolator.gradient(coefficients, indices)
        return slopes[:, ::-1] @ grid.point_to_index.matrix


def of_fixed(stage: Stage, scene: Scene) -> Points:
    """Slope of the fixed image at a level's samples, (n, dim), 0 where they do not count."""
    image, interpolator = scene.still, stage.interpolator
    slopes, counts = np.zeros_like(scene.points), scene.weight > 0.0
    points, below = scene.points[counts], scene.below
    indices = np.ascontiguousarray(image.grid.indices(points if below is None else below(points)))
    coefficients = interpolator.prepare(np.ascontiguousarray(image.values, np.float64))
    found = ImageSlopes.of(stage, image).at(indices, coefficients)
    slopes[counts] = found if below is None else below.pull(points, found)
    return slopes


@dataclass(frozen=True, eq=False)
class MovingSlopes:
    """The chain rule behind a metric's derivative."""

    stage: Stage
    scene: Scene
    slopes: ImageSlopes

    @classmethod
    def of(cls, stage: Stage, scene: Scene) -> "MovingSlopes":
        """Prepared for one level."""
        return cls(stage, scene, ImageSlopes.of(stage, scene.moving))

    def pull(self, params: Params, forces: Values, frame: Frame, mapped: Indices | None = None) -> Params:
        """Slope of the metric by each parameter.

        Parameters
        ----------
        forces : (n,) float64
            d value / d moving intensity of each sample.
        mapped : (n, dim) float64, array order, optional
            Where the samples lie in the moving image, if that has been worked out already.
        """
        transform, scene = self.stage.transform, self.scene
        affine = transform.as_affine(params, frame)
        if self.stage.gradient == "exact" and affine is not None:
            moments = self._moments(affine, forces)
            return transform.parameter_gradient(params, *levers(moments), frame)
        points = scene.points
        if mapped is None:
            mapped = scene.moving.grid.indices(transform.map(params, points, frame))
        felt = np.flatnonzero(forces)
        kept = mapped.take(felt, axis=0)
        slopes = forces.take(felt)[:, None] * self.slopes.at(kept, scene.coefficients)
        return transform.parameter_gradient(params, points.take(felt, axis=0), slopes, frame)

    def _moments(self, affine: AffineMap, forces: Values) -> Matrix:
        """sum of force (x) [point, 1] in physical space, (dim, dim + 1), from one fused pass."""
        scene, to_index, from_index = (
            self.scene,
            self.scene.moving.grid.point_to_index,
            self.scene.grid.index_to_point,
        )
        whole = (to_index @ affine @ from_index).reversed_axes()
        pulled = self.stage.interpolator.pull_back(scene.coefficients, scene.samples, whole, forces)
        matrix, offset = pulled[::-1, -2::-1], pulled[::-1, -1]
        force = to_index.matrix.T @ offset
        levered = to_index.matrix.T @ matrix @ from_index.matrix.T + np.outer(force, from_index.offset)
        return np.column_stack([levered, force])


def _central(volume: Volume, indices: Indices, grid: Grid) -> Points:
    """ITK's central differences: half a spacing along each physical axis, 0 where one end is outside."""
    points = grid.points(indices)
    slopes = np.zeros_like(points)
    for axis, spacing in enumerate(grid.spacing):
        ahead, behind = points.copy(), points.copy()
        ahead[:, axis] += spacing / 2
        behind[:, axis] -= spacing / 2
        ends = [
            Linear().resample(volume, Samples(grid.shape, grid.indices(p)), None) for p in (ahead, behind)
        ]
        both = (ends[0][1] > 0) & (ends[1][1] > 0)
        rise = ends[0][0] - ends[1][0]
        slopes[both, axis] = rise[both] / (ahead[both, axis] - behind[both, axis])
    return slopes


def levers(moments: Matrix) -> tuple[Points, Points]:
    """A few points and forces with given moments ``sum of force (x) [point, 1]``.

    An affine map's slope by its parameters depends on the forces through these moments alone, so dim + 1
    points stand for all samples: the origin and the ends of the unit vectors.
    """
    dim = len(moments)
    points = np.concatenate([np.zeros((1, dim)), np.eye(dim)])
    at_ends = moments[:, :dim].T
    return points, np.concatenate([(moments[:, dim] - at_ends.sum(axis=0))[None], at_ends])
