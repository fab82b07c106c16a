"""The unit an optimizer walks in: pixels of motion, or ITK's scales."""

from dataclasses import dataclass

import numpy as np

from regframe.engine.followed import alone
from regframe.engine.freedom import Freedom, freedom, listed
from regframe.errors import GeometryError
from regframe.geometry import Frame, Grid
from regframe.preset import Stage
from regframe.transforms.base import Transform
from regframe.types import Mask, Params, Points

VARIATION = 0.01  # ITK's small parameter variation
MOTION = ("shift", "grid-shift")
"""Scales that make coordinates of motion."""
RADIUS = 5  # ITK's central region radius


@dataclass(frozen=True, eq=False)
class Coordinates:
    """``u = (p - origin) * unit``, an optimizer's scales for `u`, and which of `u` it may change."""

    origin: Params
    unit: Params
    scales: Params
    freedom: Freedom | None = None

    @property
    def weights(self) -> Params:
        """Factors on the slopes by `u`."""
        return np.ones_like(self.origin) if self.freedom is None else self.freedom.weights

    @property
    def free(self) -> Mask:
        """Which of `u` may change."""
        return np.ones(len(self.origin), bool) if self.freedom is None else self.freedom.free

    def params(self, at: Params) -> Params:
        """The transform's parameters at coordinates (..., p)."""
        return self.origin + at / self.unit

    def start(self) -> Params:
        """Coordinates of the level's first parameters when `unit` is motion: zeros."""
        return np.zeros_like(self.origin)


def coordinates(
    stage: Stage, params: Params, frame: Frame, level_grid: Grid, moving: Grid
) -> tuple[Coordinates, Params]:
    """The level's coordinates and where in them it begins.

    The level begins at parameters in the family's domain, as ITK's levels do. With ``scales = "shift"``
    one unit of every coordinate moves some corner of the fixed grid by one pixel (or mm), with "grid-shift"
    by one spacing of the level's grid. Otherwise coordinates are the parameters themselves and ITK's scales
    go along.

    Raises
    ------
    PresetError
        A list of scales of the wrong length.
    GeometryError
        A parameter that moves nothing.
    """
    params = stage.transform.advance(params, np.zeros_like(params), frame)
    count, plain = len(params), np.ones_like(params)
    freed = freedom(stage, frame, count)
    if stage.scales in MOTION:
        unit = np.where(freed.free, stage.transform.shift(params, frame), 1.0)
        if not np.all(unit > 0):
            still = [n for n, u in zip(stage.transform.names(frame), unit, strict=True) if not u > 0]
            message = f"The parameters {still} move nothing here, so they cannot be searched. Give `scales`."
            raise GeometryError(message)
        if stage.scales == "grid-shift":
            unit = unit / min(level_grid.spacing)
        return Coordinates(params, unit, plain, freed), np.zeros_like(params)
    nowhere = np.zeros_like(params)
    if isinstance(stage.scales, tuple):
        scales = listed("scales", stage.scales, stage, frame, count)
        return Coordinates(nowhere, plain, scales, freed), params
    estimate = _itk_scales(stage.scales, stage.transform, params, frame, level_grid, moving)
    return Coordinates(nowhere, plain, estimate, freed), params


def _itk_scales(
    kind: str, transform: Transform, params: Params, frame: Frame, grid: Grid, moving: Grid
) -> Params:
    curved = alone(transform).as_affine(params, frame) is None
    points = _central_block(grid) if curved else grid.corners()
    if kind == "jacobian" and alone(transform).local:
        # Each point's motion is its parameters.
        return np.ones_like(params)
    if kind == "jacobian":
        slopes = _jacobian(transform, params, points, frame)
        return _moving_all(np.asarray((slopes**2).sum(axis=2).mean(axis=1)), kind)
    chosen = _tried(transform, params, frame)
    shifts, here = np.empty(len(chosen)), transform.map(params, points, frame)
    for i, parameter in enumerate(chosen):
        step = np.zeros_like(params)
        step[parameter] = VARIATION
        there = transform.map(transform.advance(params, step, frame), points, frame)
        shifts[i] = _largest(kind, here, there, moving)
    eps = float(np.finfo(np.float64).eps)
    if not np.any(shifts > eps):
        message = f"No parameter moves anything, so {kind!r} has no scale to give. Give `scales` as a list."
        raise GeometryError(message)
    least = shifts[shifts > eps].min()
    if alone(transform).local:
        return np.tile(np.where(shifts <= eps, least, shifts) ** 2 / VARIATION**2, len(params) // frame.dim)
    if curved:
        # ITK's rule for transforms with local support: one scale for all, and no square.
        return np.full_like(params, least)
    return np.where(shifts <= eps, least, shifts) ** 2 / VARIATION**2


def _tried(transform: Transform, params: Params, frame: Frame) -> range:
    """Parameters whose motion ITK measures: all, or those of a field's central point, which stand for all."""
    if not alone(transform).local:
        return range(len(params))
    shape = (frame.lattice or frame.grid).shape
    middle = int(np.ravel_multi_index([(n - 1) // 2 for n in shape], shape)) * frame.dim
    return range(middle, middle + frame.dim)


def _central_block(grid: Grid) -> Points:
    """Points at most `RADIUS` indices from the grid's middle, where ITK measures curved transforms."""
    ranges = [np.arange(max((n - 1) // 2 - RADIUS, 0), min((n - 1) // 2 + RADIUS + 1, n)) for n in grid.shape]
    block = np.meshgrid(*ranges, indexing="ij")
    return grid.points(np.stack([axis.ravel() for axis in block], axis=1).astype(np.float64))


def _moving_all(scales: Params, kind: str) -> Params:
    still = int(np.sum(scales <= np.finfo(np.float64).eps))
    if still:
        message = (
            f"{still} parameters move nothing where {kind!r} looks, so they have no scale. "
            'Write scales = "physical-shift", or a list.'
        )
        raise GeometryError(message)
    return scales


def _largest(kind: str, here: Points, there: Points, moving: Grid) -> float:
    """Largest distance between two maps of the points: physical, or in moving pixels."""
    if kind == "index-shift":
        here, there = moving.indices(here), moving.indices(there)
    return float(np.sqrt(((there - here) ** 2).sum(axis=1)).max())


def _jacobian(
    transform: Transform, params: Params, points: Points, frame: Frame
) -> "np.ndarray[tuple[int, ...], np.dtype[np.float64]]":
    """d map / d params at each point, (p, n, dim), one unit force at a time."""
    whole = np.empty((len(params), len(points), frame.dim))
    for n in range(len(points)):
        for axis in range(frame.dim):
            force = np.zeros((1, frame.dim))
            force[0, axis] = 1.0
            whole[:, n, axis] = transform.parameter_gradient(params, points[n : n + 1], force, frame)
    return whole


def motion(stage: Stage, params: Params, step: Params, frame: Frame, grids: tuple[Grid, Grid]) -> float:
    """Largest motion of a step of parameters, as the stage's kind of scales measures it.

    Parameters
    ----------
    grids : (Grid, Grid)
        The level's fixed grid and the moving image's.
    """
    level_grid, moving = grids
    curved = alone(stage.transform).as_affine(params, frame) is None
    if stage.scales == "jacobian" and not alone(stage.transform).local:
        points = _central_block(level_grid) if curved else level_grid.corners()
        slopes = _jacobian(stage.transform, params, points, frame)
        moved = np.einsum("p,pnd->nd", step, slopes)
        return float(np.sqrt((moved**2).sum(axis=1)).mean())
    largest = float(np.abs(step).max())
    if largest == 0.0:
        return 0.0
    # ITK measures a small step and scales the answer; far steps of a rotation would fold back.
    estimated = isinstance(stage.scales, str) and stage.scales not in MOTION
    small = VARIATION / largest if estimated and not curved else 1.0
    kind = stage.scales if isinstance(stage.scales, str) else "physical-shift"
    points = level_grid.points(level_grid.all_indices()) if curved else level_grid.corners()
    local = alone(stage.transform).local
    back = np.zeros_like(step)
    if local and not estimated:
        # A family that smooths all it has after each step moves by that too, which is no part of the step:
        # ITK counts it, and then takes short steps for long ones. Halves of both ways leave it out.
        step, back = 0.5 * step, -0.5 * step
    ends = [stage.transform.advance(params, one * small, frame) for one in (back, step)]
    here, there = (stage.transform.map(end, points, frame) for end in ends)
    if kind == "jacobian" and local:
        return float(np.sqrt(((there - here) ** 2).sum(axis=1)).mean())
    return _largest(kind, here, there, moving) / small
