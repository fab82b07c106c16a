"""The metric as a function of an optimizer's coordinates."""

import math

import numpy as np
from numpy.typing import NDArray

from regframe.engine.scales import Coordinates, motion
from regframe.engine.scene import Scene
from regframe.engine.slopes import MovingSlopes, of_fixed
from regframe.errors import NoOverlapError
from regframe.geometry import AffineMap, Frame
from regframe.interpolators.base import Samples
from regframe.interpolators.nearest import Nearest
from regframe.kernels.rounding import round_single
from regframe.metrics.base import Metric, Pairs
from regframe.preset import Stage
from regframe.types import Indices, Params, Points, Values

DIFFERENCE = 0.1  # grid spacings: wide enough that no single sample crossing a border decides a slope


class Objective:
    """A level's `Problem`: pairs, values and slopes at the optimizer's coordinates."""

    def __init__(self, stage: Stage, scene: Scene, frame: Frame, coordinates: Coordinates) -> None:
        self.stage, self.scene, self.frame, self.coordinates = stage, scene, frame, coordinates
        self.scales, self.weights = coordinates.scales, coordinates.weights
        self.evaluations = 0
        self.first = float("nan")
        self._prepared = stage.metric.prepare(self._pairs(np.zeros(0), scene.weight, None))
        self._slopes = MovingSlopes.of(stage, scene)
        pushes = type(stage.metric).forces is not Metric.forces
        self._fixed_slopes = of_fixed(stage, scene) if pushes else None

    def values(self, batch: NDArray[np.float64]) -> Values:
        """Metric at each row of a (b, p) batch, infinite where nothing overlaps."""
        metric, place = self.stage.metric, self.coordinates.params
        return np.array([self._counted(metric.value(self.pairs(place(row)))) for row in batch])

    def measured(self, params: Params) -> float:
        """The metric at the transform's parameters."""
        return self.stage.metric.value(self.pairs(params))

    def value_and_gradient(self, at: Params) -> tuple[float, Params]:
        """Metric and its slope, by the metric's derivative or by differences."""
        params = self.coordinates.params(at)
        index_map, where = placed(self.scene, self.stage, params, self.frame)
        pairs = self._met(index_map, where)
        value, slopes = self.stage.metric.value_and_derivative(pairs)
        if self._counted(value) == float("inf"):
            raise NoOverlapError(self._lost("on the way"))
        pushes = self.forces(pairs)
        if pushes is not None:
            transform, points = self.stage.transform, self.scene.points
            return value, transform.parameter_gradient(
                params, points, pushes, self.frame
            ) / self.coordinates.unit
        if slopes is None:
            return value, self._differences(at)
        mapped = where.indices if index_map is None else None
        return value, self._slopes.pull(params, slopes, self.frame, mapped) / self.coordinates.unit

    def forces(self, pairs: Pairs) -> Points | None:
        """What a metric that pushes points would do to each sample, (n, dim), uphill; None for others."""
        if self._fixed_slopes is None:
            return None
        return self.stage.metric.forces(pairs, self._fixed_slopes, self.scene.still.grid.spacing)

    def settled(self, at: Params) -> Params:
        """The transform's parameters at coordinates, as they are reported: within the family's domain."""
        params = self.coordinates.params(at)
        return self.stage.transform.advance(params, np.zeros_like(params), self.frame)

    def advance(self, at: Params, step: Params) -> Params:
        """Coordinates after a step: the sum, and what the transform's own rule makes different from it."""
        params, moved = self.coordinates.params(at), step / self.coordinates.unit
        # The bracket is exactly 0 for transforms that add, so their coordinates keep the bits of a plain sum.
        bent = self.stage.transform.advance(params, moved, self.frame) - (params + moved)
        return at + step + bent * self.coordinates.unit

    def motion(self, at: Params, step: Params) -> float:
        """Largest motion that a step makes over the grid."""
        params, moved = self.coordinates.params(at), step / self.coordinates.unit
        return motion(self.stage, params, moved, self.frame, (self.scene.grid, self.scene.moving.grid))

    def pairs(self, params: Params) -> Pairs:
        """Fixed and moving intensities that meet under some parameters."""
        return self._met(*placed(self.scene, self.stage, params, self.frame))

    def _met(self, index_map: AffineMap | None, at: Samples) -> Pairs:
        """Pairs at samples that `placed` has put into the moving image."""
        scene, interpolator = self.scene, self.stage.interpolator
        moving, weight = interpolator.resample(scene.coefficients, at, index_map)
        if scene.moving.rounds:
            round_single(moving)
        if scene.moving_mask is not None:
            weight *= Nearest().resample(scene.moving_mask, at, index_map)[0]
        if not scene.complete:
            weight *= scene.weight
        return self._pairs(moving, weight, self._prepared)

    def _pairs(self, moving: Values, weight: Values, prepared: object) -> Pairs:
        scene = self.scene
        shape = scene.samples.shape if scene.samples.indices is None else None
        ranges, single = (scene.fixed_range, scene.moving_range), scene.moving.rounds
        return Pairs(scene.fixed, moving, weight, *ranges, shape, prepared, single)

    def _counted(self, value: float) -> float:
        if not math.isfinite(value):
            value = float("inf")
        if self.evaluations == 0:
            self.first = value
            if value == float("inf"):
                raise NoOverlapError(self._lost("at the start"))
        self.evaluations += 1
        return value

    def _lost(self, when: str) -> str:
        return (
            f"The images share nothing to compare {when} (metric {type(self.stage.metric).__name__}, "
            f"{len(self.scene.samples)} samples). Check the masks and geometry, begin nearer with `start`, "
            "or take smaller steps."
        )

    def _differences(self, at: Params) -> Params:
        """Central differences of the value."""
        reach = self.stage.transform.shift(self.coordinates.params(at), self.frame) / self.coordinates.unit
        step = DIFFERENCE * min(self.scene.grid.spacing) / np.maximum(reach, 1e-12)
        batch = np.concatenate([at + np.diag(step), at - np.diag(step)])
        values = self.values(batch)
        slopes = (values[: len(at)] - values[len(at) :]) / (2 * step)
        if not np.isfinite(slopes).all():
            raise NoOverlapError(self._lost("on the way"))
        return slopes


def placed(scene: Scene, stage: Stage, params: Params, frame: Frame) -> tuple[AffineMap | None, Samples]:
    """How samples reach the moving image: an affine index map, or indices already there."""
    affine = stage.transform.as_affine(params, frame)
    grid = scene.moving.grid
    if affine is None:
        mapped: Indices = grid.indices(stage.transform.map(params, scene.points, frame))
        return None, Samples(scene.samples.shape, mapped)
    whole = grid.point_to_index @ affine @ scene.grid.index_to_point
    return whole.reversed_axes(), scene.samples
