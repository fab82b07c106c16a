"""An objective whose features are carried along by the map in place of being made anew at each step."""

import math

import numpy as np
from numpy.typing import NDArray

from regframe.engine.objective import Objective
from regframe.engine.scales import Coordinates
from regframe.engine.scene import Scene
from regframe.engine.slopes import levers
from regframe.errors import GeometryError, NoOverlapError
from regframe.geometry import AffineMap, Frame, Grid
from regframe.interpolators.base import Samples
from regframe.interpolators.nearest import Nearest
from regframe.metrics.base import Carried
from regframe.preset import Stage
from regframe.types import Matrix, Params, Values

MARGIN = 8
"""Grid points about the fixed grid on which features exist, so that steps there meet something."""
FINER = 0.95
"""Of the grid's spacing: were it the same, the level would begin with points on points, where nothing is
blurred by interpolation, and stay there."""


class CarriedObjective(Objective):
    """The moving image is laid on the fixed grid as the level begins, and its features are made there, once.

    From then on maps move the features. That is exact where the features turn and grow with the image, and
    near enough for steps of a few grid points; an evaluation costs a quarter.
    """

    def __init__(
        self, stage: Stage, scene: Scene, frame: Frame, coordinates: Coordinates, start: Params
    ) -> None:
        super().__init__(stage, scene, frame, coordinates)
        first, canvas = self._affine(start), _widened(scene.grid)
        self.carried = self._laid(canvas, first)
        self.back = canvas.point_to_index @ first.inverse()
        # The index map, array order, is end @ (matrix, offset of the map) @ begin + shift.
        self.end = self.back.matrix[::-1]
        whole = scene.grid.index_to_point.homogeneous()
        self.begin = np.concatenate([whole[:, -2::-1], whole[:, -1:]], axis=1)
        self.shift = np.zeros((scene.grid.dim, scene.grid.dim + 1))
        self.shift[:, -1] = self.back.offset[::-1]

    def values(self, batch: NDArray[np.float64]) -> Values:
        """Metric at each row of a (b, p) batch, infinite where nothing overlaps."""
        place = self.coordinates.params
        return np.array([self._counted(self.carried.value(self._index_map(place(row)))) for row in batch])

    def value_and_gradient(self, at: Params) -> tuple[float, Params]:
        """Metric and its slope."""
        params = self.coordinates.params(at)
        value, pulled = self.carried.value_and_slope(self._index_map(params))
        if self._counted(value) == float("inf"):
            raise NoOverlapError(self._lost("on the way"))
        # Forces on moving points, and their levers about fixed ones: the chain rule of `_index_map`.
        moments = self.end.T @ pulled @ self.begin.T
        slope = self.stage.transform.parameter_gradient(params, *levers(moments), self.frame)
        return value, slope / self.coordinates.unit

    def _laid(self, canvas: Grid, first: AffineMap) -> Carried:
        """Features on a grid about the fixed one, made under a map."""
        scene, at = self.scene, Samples(canvas.shape)
        index_map = (scene.moving.grid.point_to_index @ first @ canvas.index_to_point).reversed_axes()
        values, weight = self.stage.interpolator.resample(scene.coefficients, at, index_map)
        if scene.moving_mask is not None:
            weight *= Nearest().resample(scene.moving_mask, at, index_map)[0]
        pairs = self._pairs(np.zeros(0), scene.weight, self._prepared)
        made = self.stage.metric.carried(pairs, values.reshape(canvas.shape), weight.reshape(canvas.shape))
        if made is None:
            message = f"levels: carried features are for 2-D images. Got {canvas.dim}-D. Leave `carried` out."
            raise GeometryError(message)
        return made

    def _index_map(self, params: Params) -> Matrix:
        affine, dim = self._affine(params), self.scene.grid.dim
        between = np.empty((dim, dim + 1))
        between[:, :dim], between[:, dim] = affine.matrix, affine.offset
        return np.asarray(self.end @ between @ self.begin + self.shift)

    def _affine(self, params: Params) -> AffineMap:
        affine = self.stage.transform.as_affine(params, self.frame)
        if affine is None:
            name = type(self.stage.transform).__name__
            message = f"levels: only maps without bends carry features. Got {name}. Leave `carried` out."
            raise GeometryError(message)
        return affine


def _widened(grid: Grid) -> Grid:
    """A grid about another one, a little finer."""
    first = grid.points(np.full((1, grid.dim), -float(MARGIN)))[0]
    shape = tuple(math.ceil((n + 2 * MARGIN) / FINER) for n in grid.shape)
    return Grid(shape, tuple(FINER * s for s in grid.spacing), tuple(map(float, first)), grid.direction)
