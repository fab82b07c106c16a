"""A start by search: every rotation, scale and shift within bounds, coarsely."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np
from numpy.typing import NDArray

from regframe.engine.averaging import averaged, fitting, magnification, reduction
from regframe.engine.candidate import Place
from regframe.engine.setting import Setting
from regframe.engine.start import base_scale, placed_on
from regframe.errors import GeometryError, NoOverlapError
from regframe.geometry import AffineMap, Frame, Grid
from regframe.image import Image
from regframe.interpolators.base import Samples
from regframe.interpolators.linear import Linear
from regframe.kernels.fourier import lattice
from regframe.kernels.jit import share
from regframe.metrics.base import Pairs, Translations
from regframe.preset import Search, Stage
from regframe.transforms.linear import about, turn
from regframe.types import Params, Points, Volume

EACH = 3
"""Shifts that are kept of each rotation and scale."""
APART = 3.0
"""Grid points between corners, on average, from which on two places are distinct."""
STRIDE = 2
"""Grid points between shifts where they are measured one by one."""


def search(stage: Stage, fixed: Image, moving: Image, setting: Setting) -> tuple[Place, ...]:
    """Distinct places, the best first; as many as the first level is to keep.

    Parameters
    ----------
    stage : Stage
        Whose `start` is a Search.
    fixed, moving : Image
        After their filters.
    setting : Setting
        Whose domain the places speak of.

    Raises
    ------
    GeometryError
        Images that are not 2-D.
    NoOverlapError
        No shift within the bounds lets the images overlap enough.
    """
    options = stage.start
    assert isinstance(options, Search)
    if fixed.dim != 2:
        message = f"start: a search is for 2-D images. Got {fixed.dim}-D. Begin with centres or moments."
        raise GeometryError(message)
    field = _Field(stage, options, (fixed, moving), setting)
    places = field.places()
    found: list[list[Place]] = [[] for _ in places]
    share(partial(_score_places, field, places, found), len(places))
    ranked = sorted((one for few in found for one in few), key=lambda one: one.value)
    if not ranked:
        message = (
            f"start: no shift within {options.shift:g} of the frame lets the images overlap by "
            f"{options.overlap:g}. Widen `shift`, or lower `overlap`."
        )
        raise NoOverlapError(message)
    return distinct(ranked, options.keep[0], setting.domain, APART * min(field.grid.spacing))


def _score_places(
    field: "_Field", places: list[tuple[float, float]], found: list[list[Place]], first: int, last: int
) -> None:
    for i in range(first, last):
        found[i] = field.score(*places[i])


def distinct(ranked: list[Place], most: int, grid: Grid, apart: float) -> tuple[Place, ...]:
    """The first candidates of a list whose corners lie apart from those of all before, at most so many."""
    kept: list[Place] = []
    corners: list[Points] = []
    for one in ranked:
        reached = one.seen(grid.corners())
        limit = apart * magnification(one.seen)
        if all(np.linalg.norm(reached - other, axis=1).mean() > limit for other in corners):
            kept.append(one)
            corners.append(reached)
        if len(kept) == most:
            break
    return tuple(kept)


@dataclass(frozen=True, eq=False)
class _Canvas:
    """The moving image on a grid in line with the fixed one."""

    values: Volume
    weight: Volume
    first: tuple[int, int]  # index of the fixed grid's first point in it, may be negative


class _Field:
    """What a search looks at: the small fixed image, the moving one at some sizes, the bounds."""

    def __init__(self, stage: Stage, options: Search, images: tuple[Image, Image], setting: Setting) -> None:
        fixed, moving = images
        self.stage, self.options, self.moving, self.setting = stage, options, moving, setting
        self.frame = Frame.about_centre(fixed.grid, moving.grid)
        self.fixed = averaged(fixed, fitting(fixed.grid.shape, options.size))
        self.grid = self.fixed.grid
        self.unit = base_scale(options, fixed.grid, moving.grid)
        weight = (
            np.ones(self.grid.size) if self.fixed.mask is None else self.fixed.mask.ravel().astype(np.float64)
        )
        self.pairs = Pairs(
            np.asarray(self.fixed.values, np.float64).ravel(),
            np.empty(0),
            weight,
            self.fixed.range(),
            moving.range(),
            self.grid.shape,
        )

    def places(self) -> list[tuple[float, float]]:
        """Rotations (radians) and scales that are tried, as far as the family has them."""
        radius = float(np.linalg.norm(self.grid.shape)) / 2
        stride = self.options.step / radius
        most = np.deg2rad(self.options.rotation_deg)
        low, high = np.log(self.options.scale)
        turns = _lattice(-most, most, stride) if self._has(turn(0.1)) else np.zeros(1)
        sizes = _lattice(low, high, stride) if self._has(1.1 * np.eye(2)) else np.clip(np.zeros(1), low, high)
        return [(float(angle), float(np.exp(size))) for size, angle in product(sizes, turns)]

    def _has(self, matrix: NDArray[np.float64]) -> bool:
        transform = self.stage.transform
        target = about(matrix, np.zeros(2), self.frame.centre)
        back = transform.as_affine(transform.from_affine(target, self.frame), self.frame)
        return back is not None and bool(np.allclose(back.matrix, matrix, atol=1e-6))

    def score(self, angle: float, scale: float) -> list[Place]:
        """The best few shifts at a rotation and a scale."""
        centred = about(
            self.unit * scale * turn(angle), self.moving.grid.centre - self.frame.centre, self.frame.centre
        )
        canvas = self._canvas(centred, self.unit * scale)
        reach = self._reach(scale)
        shape = lattice(
            max(n, m, (n + m) / 2 + r + 1)
            for n, m, r in zip(self.grid.shape, canvas.values.shape, reach, strict=True)
        )
        score = self.stage.metric.translations(self.pairs, shape)
        if score is None:
            score = self._one_by_one(shape, reach, canvas)
        values, shared = score(canvas.values, canvas.weight)
        shifts = [np.arange(n) for n in shape]
        # Translation t lets fixed x meet canvas x + t; the two centres meet at `first`.
        off = [(s - f + n // 2) % n - n // 2 for s, f, n in zip(shifts, canvas.first, shape, strict=True)]
        near = np.abs(off[0])[:, None] <= reach[0]
        near = near & (np.abs(off[1])[None] <= reach[1])
        smaller = min(float(self.pairs.weight.sum()), float(canvas.weight.sum()))
        share_met = np.asarray(shared) / max(smaller, 1.0)
        bounded = np.where(near & (share_met >= self.options.overlap), values, np.inf)
        found = []
        for y, x in _lowest(bounded, EACH):
            move = np.array([off[1][x], off[0][y]], np.float64)
            shift = self.grid.index_to_point.matrix @ move
            affine = centred @ AffineMap(np.eye(2), shift)
            warp = placed_on(self.stage, affine, self.moving.grid, self.setting)
            found.append(Place(warp, warp, float(bounded[y, x]), float(share_met[y, x])))
        return found

    def _reach(self, scale: float) -> tuple[float, float]:
        """Largest shift along each axis, array order, in grid points."""
        wide = [
            max(n * s, m * r / (self.unit * scale)) / s
            for n, s, m, r in zip(
                self.grid.shape,
                reversed(self.grid.spacing),
                self.moving.grid.shape,
                reversed(self.moving.grid.spacing),
                strict=True,
            )
        ]
        return self.options.shift * wide[0], self.options.shift * wide[1]

    def _canvas(self, centred: AffineMap, scale: float) -> _Canvas:
        """The moving image under a map that brings the centres together."""
        small = averaged(self.moving, reduction(self.grid, self.moving.grid, scale))
        back = self.grid.point_to_index @ centred.inverse()
        corners = back(_outline(self.moving.grid))[:, ::-1]
        first, last = np.floor(corners.min(axis=0)).astype(int), np.ceil(corners.max(axis=0)).astype(int)
        shape = tuple(int(n) for n in last - first + 1)
        origin = tuple(map(float, self.grid.points(first[None].astype(np.float64))[0]))
        grid = Grid(shape, self.grid.spacing, origin, self.grid.direction)
        index_map = (small.grid.point_to_index @ centred @ grid.index_to_point).reversed_axes()
        values, weight = Linear().resample(
            np.ascontiguousarray(small.values, np.float64), Samples(shape), index_map
        )
        if small.mask is not None:
            met, _ = Linear().resample(small.mask.astype(np.float64), Samples(shape), index_map)
            weight = weight * (met > 0.99)
        return _Canvas(values.reshape(shape), weight.reshape(shape), (-int(first[0]), -int(first[1])))

    def _one_by_one(
        self, shape: tuple[int, ...], reach: tuple[float, float], canvas: _Canvas
    ) -> Translations:
        """The metric itself at every other translation, for metrics without a quicker way."""
        metric, pairs = self.stage.metric, self.pairs
        prepared = metric.prepare(pairs)
        offsets = [
            range(int(f - r), int(f + r) + 1, STRIDE) for f, r in zip(canvas.first, reach, strict=True)
        ]

        def score(moving: Volume, weight: Volume) -> tuple[Volume, Volume]:
            values, shared = np.full(shape, np.inf), np.zeros(shape)
            for y, x in product(*offsets):
                met, there = (_window(one, (y, x), self.grid.shape) for one in (moving, weight))
                there = there * pairs.weight
                shared[y % shape[0], x % shape[1]] = there.sum()
                one = Pairs(
                    pairs.fixed, met, there, pairs.fixed_range, pairs.moving_range, pairs.shape, prepared
                )
                value = metric.value(one) if there.any() else np.inf
                values[y % shape[0], x % shape[1]] = value if np.isfinite(value) else np.inf
            return values, shared

        return score


def _lattice(low: float, high: float, stride: float) -> NDArray[np.float64]:
    """Evenly from low to high, no further apart than a stride."""
    count = int(np.ceil((high - low) / stride - 1e-9)) + 1
    return np.linspace(low, high, count) if count > 1 else np.array([(low + high) / 2])


def _outline(grid: Grid) -> Points:
    """Outer corners of the corner pixels."""
    far = np.array(grid.shape, np.float64) - 0.5
    return grid.points(np.array(list(product(*((-0.5, end) for end in far)))))


def _lowest(values: Volume, most: int) -> Iterator[tuple[int, int]]:
    """Places of the lowest local minima, of 3 by 3 neighbours, at most so many."""
    around = np.minimum.reduce([np.roll(values, shift, (0, 1)) for shift in product((-1, 0, 1), repeat=2)])
    places = np.flatnonzero((values == around) & np.isfinite(values))
    order = np.argsort(values.ravel()[places], kind="stable")[:most]
    for place in places[order]:
        y, x = divmod(int(place), values.shape[1])
        yield y, x


def _window(volume: Volume, offset: tuple[int, int], shape: tuple[int, ...]) -> Params:
    """Values of a canvas from an offset on, zeros where it ends."""
    out = np.zeros(shape)
    spans = [(max(0, -o), min(n, m - o)) for o, n, m in zip(offset, shape, volume.shape, strict=True)]
    if all(low < high for low, high in spans):
        there = tuple(slice(low + o, high + o) for (low, high), o in zip(spans, offset, strict=True))
        out[tuple(slice(*span) for span in spans)] = volume[there]
    return out.ravel()
