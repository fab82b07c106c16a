"""The second floor: SimpleITK reads the intensities, the preset's own metric judges them."""

from dataclasses import replace
from math import ceil, log10

import numpy as np

from regframe.geometry import Grid
from regframe.image import Image
from regframe.io.convert import array_to_sitk
from regframe.metrics.base import Pairs
from regframe.peer import probe, twins
from regframe.peer.bench import Bench
from regframe.peer.components import attempted, precision, relative
from regframe.peer.report import Floor, Line, measured
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Chain, Warp
from regframe.types import Params, Points, Values

FLOOR: Floor = "pairs"
DIGITS = 11
"""Digits that intensities of float64 images keep: their last ones are noise of the way they were read,
and integer grey levels lie on edges of histograms, where noise would decide."""


def compare(bench: Bench, title: str) -> list[Line]:
    """The metric on pairs of either make, at the answer and around it."""
    return [
        attempted(FLOOR, f"{title}metric of intensities read by SimpleITK", value, bench),
        attempted(FLOOR, f"{title}samples inside both images and masks", count, bench),
    ]


def value(bench: Bench, what: str) -> Line:
    """The metric's values."""
    metric, positions = bench.stage.metric, _positions(bench)
    ours = np.array([metric.value(bench.objective.pairs(params)) for params in positions])
    theirs = np.array([metric.value(built(bench, params)) for params in positions])
    # Rounded intensities are good to ten digits, and metrics may sharpen differences of them.
    bound = 1e2 * precision(bench)
    return measured(FLOOR, what, relative(ours, theirs), bound, "of the value")


def count(bench: Bench, what: str) -> Line:
    """Samples that only one side holds to be inside."""
    pairs = [(bench.objective.pairs(params), built(bench, params)) for params in _positions(bench)]
    apart = max(int(np.count_nonzero((one.weight > 0) != (two.weight > 0))) for one, two in pairs)
    return measured(FLOOR, what, apart, 0, "samples")


def built(bench: Bench, params: Params) -> Pairs:
    """Pairs of the last level at some parameters, made without any interpolation of ours.

    Raises
    ------
    NoTwin
        SimpleITK lacks the interpolator.
    """
    scene, (fixed, moving) = bench.objective.scene, bench.theirs
    sparse = scene.samples.indices is not None
    points = scene.points if sparse else None
    here = bench.setting.below or Warp(Translation(), np.zeros(fixed.dim), bench.warp.frame)
    name = twins.interpolator(bench.stage.interpolator)
    below, first = _read(fixed, here, bench.grid, points, name)
    above, second = _read(moving, bench.onward(params), bench.grid, points, name)
    fixed_range = scene.fixed_range if sparse else fixed.range()
    pairs = Pairs(
        below,
        above,
        (first & second).astype(np.float64),
        fixed_range,
        moving.range(),
        None if sparse else scene.samples.shape,
        single=moving.rounds,
    )
    # The fixed image's features are made before any map, so what the moving one shows does not count.
    alone = replace(pairs, moving=np.zeros(0), weight=first.astype(np.float64))
    return replace(pairs, prepared=bench.stage.metric.prepare(alone))


def _read(
    image: Image, warp: Warp | Chain, grid: Grid, points: Points | None, name: str
) -> tuple[Values, "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]"]:
    """Values through a warp and which of them exist and count, on a grid or at points of it."""
    masks = [] if image.mask is None else [image.with_rounded(image.mask)]
    ways = [(image, name), *((mask, "sitkNearestNeighbor") for mask in masks)]
    if points is None:
        like = array_to_sitk(np.zeros(grid.shape, np.uint8), grid)
        found = [probe.resampled(one, warp, like, way, double=False).ravel() for one, way in ways]
    else:
        there = probe.mapped(warp, points)
        found = [probe.at_points(one, there, way, double=False) for one, way in ways]
    values, inside = found[0], np.isfinite(found[0])
    for mask in found[1:]:
        inside &= mask > 0
    return _rounded(np.where(inside, values, 0.0), image), inside


def _rounded(values: Values, image: Image) -> Values:
    if image.rounds:
        return values
    low, high = image.range()
    return np.round(values, DIGITS - ceil(log10(max(abs(low), abs(high)))))


def _positions(bench: Bench) -> list[Params]:
    """The answer, and four places some pixels off it."""
    rng = np.random.default_rng(3)
    unit = bench.unit
    size = 2.0 * min(bench.grid.spacing) / np.where(unit > 0, unit, np.inf)
    near = [bench.warp.params + rng.normal(size=len(unit)) * size for _ in range(4)]
    return [bench.warp.params, *near]
