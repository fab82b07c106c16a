"""A start by search: every rotation, scale and shift within bounds, coarsely."""

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regframe.engine.averaging import Pyramid, fitting, magnification, reduction
from regframe.engine.candidate import Place, surely
from regframe.engine.setting import Setting
from regframe.engine.start import base_scale, placed_on
from regframe.errors import GeometryError, NoOverlapError
from regframe.geometry import AffineMap, Frame, Grid
from regframe.image import Image
from regframe.interpolators.base import Samples
from regframe.interpolators.linear import Linear
from regframe.kernels.fourier import lattice
from regframe.kernels.lowest import lowest
from regframe.kernels.sharing import share
from regframe.metrics.base import Pairs, Turned, Turning
from regframe.preset import Search, Stage
from regframe.transforms.linear import about, turn
from regframe.transforms.warp import Chain, Warp
from regframe.types import Params, Points, Scores, Volume

EACH = 3
"""Shifts that are kept of each rotation and scale."""
NEAR = 4
"""Grid points between these shifts, along either axis."""
APART = 6.0
"""Grid points between corners, on average, from which on two places are distinct."""
WHOLE = 0.99
"""Mask interpolated between pixels that count; less is touched by one that does not."""
STRIDE = 2
"""Grid points between shifts where they are measured one by one."""


def search(stage: Stage, pyramid: Pyramid, setting: Setting) -> tuple[Place, ...]:
    """Distinct places, the best first; as many as the first level is to keep.

    Parameters
    ----------
    stage : Stage
        Whose `start` is a Search.
    pyramid : Pyramid
        Both images, after their filters.
    setting : Setting
        Whose domain the places speak of.

    Raises
    ------
    GeometryError
        Images that are not 2-D.
    NoOverlapError
        No shift within the bounds lets the images overlap enough.
    """
    options, ranked = stage.start, tried(stage, pyramid, setting)
    assert isinstance(options, Search)
    if not ranked:
        message = (
            f"start: no shift within {options.shift:g} of the frame lets the images overlap by "
            f"{options.overlap:g}. Widen `shift`, or lower `overlap`."
        )
        raise NoOverlapError(message)
    fixed = pyramid.images[0].grid
    apart = APART * min(fixed.spacing) * fitting(fixed.shape, options.size)
    return distinct((one.place() for one in ranked), options.keep[0], setting.domain, apart)


def tried(stage: Stage, pyramid: Pyramid, setting: Setting) -> list["Shift"]:
    """The best few shifts of every rotation and scale, sorted; see `search`."""
    options, dim = stage.start, pyramid.images[0].dim
    assert isinstance(options, Search)
    if dim != 2:
        message = f"start: a search is for 2-D images. Got {dim}-D. Begin with centres or moments."
        raise GeometryError(message)
    field = _Field(stage, options, pyramid, setting)
    factors = field.scales()
    made: list[_Scale | None] = [None] * len(factors)
    for scale in factors:
        field.small(scale)
    share(partial(_make_scales, field, factors, made), len(factors))
    scales = [one for one in made if one is not None]
    # Turn by turn, so that parts of the list are equally large canvases' work.
    places = [(scale, angle) for angle in field.turns() for scale in scales]
    found: list[list[Shift]] = [[] for _ in places]
    share(partial(_score_places, places, found), len(places))
    return sorted((one for few in found for one in few), key=Shift.rank)


def _make_scales(
    field: "_Field", scales: list[float], made: list["_Scale | None"], first: int, last: int
) -> None:
    for i in range(first, last):
        made[i] = _Scale(field, scales[i])


def _score_places(
    places: list[tuple["_Scale", float]], found: list[list["Shift"]], first: int, last: int
) -> None:
    for i in range(first, last):
        scale, angle = places[i]
        found[i] = scale.score(angle)


def distinct(ranked: Iterable[Place], most: int, grid: Grid, apart: float) -> tuple[Place, ...]:
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


def within(options: Search, warp: Warp | Chain, fixed: Grid, moving: Grid) -> bool:
    """Whether a map that was found keeps to a search's rotations and scales, give or take the widest step."""
    affine = warp.as_affine()
    if affine is None:
        return True
    slack = options.step / (options.size / 2)  # of a frame that is far longer than high
    (a, b), (c, d) = affine.matrix
    angle, scale = np.arctan2(c - b, a + d), np.sqrt(abs(a * d - b * c)) / base_scale(options, fixed, moving)
    low, high = options.scale
    turned = abs(angle) <= np.deg2rad(options.rotation_deg) + slack
    return bool(turned and low * (1.0 - slack) <= scale <= high * (1.0 + slack))


class _Field:
    """What a search looks at: the small fixed image, the moving one at some sizes, the bounds."""

    def __init__(self, stage: Stage, options: Search, pyramid: Pyramid, setting: Setting) -> None:
        fixed, moving = pyramid.images
        self.pyramid = pyramid
        self.stage, self.options, self.moving, self.setting = stage, options, moving, setting
        self.frame = Frame.about_centre(fixed.grid, moving.grid)
        self.fixed = pyramid.averaged(0, fitting(fixed.grid.shape, options.size))
        self.grid = self.fixed.grid
        self.unit = base_scale(options, fixed.grid, moving.grid)
        weight = (
            np.ones(self.grid.size) if self.fixed.mask is None else self.fixed.mask.ravel().astype(np.float64)
        )
        pairs = Pairs(
            np.asarray(self.fixed.values, np.float64).ravel(),
            np.empty(0),
            weight,
            self.fixed.range(),
            moving.range(),
            self.grid.shape,
        )
        self.pairs = replace(pairs, prepared=stage.metric.prepare(pairs))
        self.outline = _outline(moving.grid)
        self.mass = float(weight.sum())

    def small(self, scale: float) -> Image:
        """The moving image averaged to about the spacing of the grid, at a scale."""
        return self.pyramid.averaged(1, reduction(self.grid, self.moving.grid, self.unit * scale))

    def turns(self) -> list[float]:
        """Rotations (radians) that are tried, as far as the family has them."""
        most = np.deg2rad(self.options.rotation_deg)
        return list(map(float, _cells(-most, most, self._stride()))) if self._has(turn(0.1)) else [0.0]

    def scales(self) -> list[float]:
        """Scales that are tried, as far as the family has them."""
        low, high = np.log(self.options.scale)
        if self._has(1.1 * np.eye(2)):
            return list(map(float, np.exp(_cells(low, high, self._stride()))))
        return [1.0 / self.unit] if self.unit != 1.0 else [1.0]

    def _stride(self) -> float:
        return self.options.step / (float(np.linalg.norm(self.grid.shape)) / 2)

    def _has(self, matrix: NDArray[np.float64]) -> bool:
        transform = self.stage.transform
        target = about(matrix, np.zeros(2), self.frame.centre)
        back = transform.as_affine(transform.from_affine(target, self.frame), self.frame)
        return back is not None and bool(np.allclose(back.matrix, matrix, atol=1e-6))


class _Scale:
    """One scale of a search: the moving image averaged for it, and the fixed one ready to be met."""

    def __init__(self, field: _Field, scale: float) -> None:
        self.field, self.magnification = field, field.unit * scale
        moving, grid = field.moving, field.grid
        self.moving = field.small(scale)
        lengths = [
            max(n * s, m * r / self.magnification) / s
            for n, s, m, r in zip(
                grid.shape,
                reversed(grid.spacing),
                moving.grid.shape,
                reversed(moving.grid.spacing),
                strict=True,
            )
        ]
        self.reach = tuple(field.options.shift * length for length in lengths)
        self.centred = {angle: self._centred(angle) for angle in (0.0, *field.turns())}
        self.canvases = {angle: self._canvas_grid(one) for angle, one in self.centred.items()}
        widest = [max(sizes) for sizes in zip(*(one.shape for one in self.canvases.values()), strict=True)]
        self.shape = lattice(
            max(n, m, (n + m) / 2 + r + 1) for n, m, r in zip(grid.shape, widest, self.reach, strict=True)
        )
        metric = field.stage.metric
        self.translations = metric.translations(field.pairs, self.shape)
        upright = self.canvases[0.0]
        self.upright = upright.point_to_index @ self.centred[0.0].inverse()
        values, weight = self._canvas(upright, self.centred[0.0])
        self.mass = float(weight.sum())
        self.turned: Turned | None = None
        if isinstance(self.translations, Turning):
            self.turned = self.translations.upright(values, weight)

    def score(self, angle: float) -> list["Shift"]:
        """The best few shifts at a rotation."""
        field, grid = self.field, self.canvases[angle]
        # Translation t lets fixed x meet canvas x + t; the two centres meet at `met`.
        met = np.rint(field.grid.point_to_index(np.array([grid.origin]))[0, ::-1]).astype(int)
        off = [(np.arange(n) + f + n // 2) % n - n // 2 for n, f in zip(self.shape, met, strict=True)]
        scored, shared = self._everywhere(angle, off, (int(met[0]), int(met[1])))
        rows, columns = (np.flatnonzero(np.abs(o) <= r) for o, r in zip(off, self.reach, strict=True))
        smaller = max(min(field.mass, self.mass), 1.0)
        best = lowest(scored, shared, (rows, columns), field.options.overlap * smaller, EACH, NEAR)
        found = []
        for y, x in best.tolist():
            value, meets = float(scored[y, x]), float(shared[y, x])
            shift = float(off[1][x]), float(off[0][y])
            found.append(Shift(self, angle, shift, value, meets / smaller, meets / field.mass))
        return found

    def place(self, angle: float, shift: tuple[float, float]) -> Warp:
        """The map at a rotation and a shift, x first, in grid points."""
        field, grid = self.field, self.field.grid
        shifted = AffineMap(np.eye(2), grid.index_to_point.matrix @ np.array(shift))
        affine = self.centred[angle] @ shifted
        return placed_on(field.stage, affine, field.moving.grid, field.setting)

    def _everywhere(
        self, angle: float, off: list[NDArray[np.int64]], met: tuple[int, int]
    ) -> tuple[Scores, Scores]:
        """Values and shared weights at a rotation, at all shifts of the lattice."""
        grid, centred = self.canvases[angle], self.centred[angle]
        if self.turned is not None:
            index_map = (self.upright @ centred @ grid.index_to_point).reversed_axes().homogeneous()[:-1]
            return self.turned(index_map, (grid.shape[0], grid.shape[1]), angle)
        if self.translations is not None:
            return self.translations(*self._canvas(grid, centred))
        return self._one_by_one(*self._canvas(grid, centred), off, met)

    def _centred(self, angle: float) -> AffineMap:
        """The map at this scale and a rotation that brings both centres together."""
        centre = self.field.frame.centre
        return about(self.magnification * turn(angle), self.field.moving.grid.centre - centre, centre)

    def _canvas_grid(self, centred: AffineMap) -> Grid:
        """The grid, in line with the fixed one, that holds the whole moving image under a map."""
        grid = self.field.grid
        back = grid.point_to_index @ centred.inverse()
        corners = back(self.field.outline)[:, ::-1]
        first, last = np.floor(corners.min(axis=0)), np.ceil(corners.max(axis=0))
        shape = tuple(int(n) for n in last - first + 1)
        return Grid(shape, grid.spacing, tuple(map(float, grid.points(first[None])[0])), grid.direction)

    def _canvas(self, grid: Grid, centred: AffineMap) -> tuple[Volume, Volume]:
        """The moving image's values and weights on a canvas."""
        small, samples = self.moving, Samples(grid.shape)
        index_map = (small.grid.point_to_index @ centred @ grid.index_to_point).reversed_axes()
        values, weight = Linear().resample(np.ascontiguousarray(small.values, np.float64), samples, index_map)
        if small.mask is not None:
            met, _ = Linear().resample(small.mask.astype(np.float64), samples, index_map)
            weight = weight * (met > WHOLE)
        return values.reshape(grid.shape), weight.reshape(grid.shape)

    def _one_by_one(
        self, moving: Volume, weight: Volume, off: list[NDArray[np.int64]], met: tuple[int, int]
    ) -> tuple[Volume, Volume]:
        """The metric itself at every other translation, for metrics without a quicker way."""
        pairs, metric = self.field.pairs, self.field.stage.metric
        values, shared = np.full(self.shape, np.inf), np.zeros(self.shape)
        rows, columns = (
            np.flatnonzero((np.abs(o) <= r) & (o % STRIDE == 0)) for o, r in zip(off, self.reach, strict=True)
        )
        for y, x in product(rows.tolist(), columns.tolist()):
            at = (int(off[0][y]) - met[0], int(off[1][x]) - met[1])
            values_met, there = (_window(one, at, self.field.grid.shape) for one in (moving, weight))
            there = there * pairs.weight
            shared[y, x] = there.sum()
            one = replace(pairs, moving=values_met, weight=there)
            value = metric.value(one) if there.any() else np.inf
            values[y, x] = value if np.isfinite(value) else np.inf
        return values, shared


class Shift(NamedTuple):
    """One of the best shifts at a scale and a rotation."""

    scale: _Scale
    angle: float
    shift: tuple[float, float]  # x first, grid points
    value: float
    overlap: float
    met: float

    def rank(self) -> float:
        """What shifts are sorted by, lower first; as `Place.rank`."""
        return surely(self.scale.field.stage.metric, self.value, self.overlap, self.met)

    def place(self) -> Place:
        """The same as a map of the stage's family."""
        warp = self.scale.place(self.angle, self.shift)
        return Place(warp, warp, self.value, self.overlap, met=self.met)


def _cells(low: float, high: float, stride: float) -> NDArray[np.float64]:
    """Middles of equal parts of a range, none wider than a stride: each place stands for what is near it."""
    count = max(1, int(np.ceil((high - low) / stride - 1e-9)))
    return np.asarray(low + (high - low) * (np.arange(count) + 0.5) / count)


def _outline(grid: Grid) -> Points:
    """Outer corners of the corner pixels."""
    far = np.array(grid.shape, np.float64) - 0.5
    return grid.points(np.array(list(product(*((-0.5, end) for end in far)))))


def _window(volume: Volume, offset: tuple[int, int], shape: tuple[int, ...]) -> Params:
    """Values of a canvas from an offset on, zeros where it ends."""
    out = np.zeros(shape)
    spans = [(max(0, -o), min(n, m - o)) for o, n, m in zip(offset, shape, volume.shape, strict=True)]
    if all(low < high for low, high in spans):
        there = tuple(slice(low + o, high + o) for (low, high), o in zip(spans, offset, strict=True))
        out[tuple(slice(*span) for span in spans)] = volume[there]
    return out.ravel()
