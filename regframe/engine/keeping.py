"""Whether a richer map earns its keep over the simpler one it began from, by tiles held out of its fit."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from regframe.engine.choice import FEWEST, Choice
from regframe.engine.objective import Objective
from regframe.engine.scene import Scene
from regframe.errors import NoOverlapError
from regframe.geometry import Grid
from regframe.image import Image
from regframe.interpolators.base import Samples
from regframe.metrics.base import Metric, Pairs
from regframe.transforms.warp import Warp
from regframe.types import Bins, Mask, Params, Values

TILES = 8
"""Tiles along the longest axis of the fixed image."""
COUNTS = 0.5
"""Share of a tile's samples that must count under both maps."""

Fit = Callable[[Image], Warp]


def chosen(stage: int, gains: Values, least: float) -> Choice:
    """Judge the gains of held-out tiles.

    The mean gain must be beyond `least` of its standard errors, and so must the number of better tiles be
    beyond half of all (a sign test): neither a slight gain that may be chance, nor a large one in a few
    tiles, is enough. With `least` below 0 the richer map stays unless its mean is worse by more than so many.

    Parameters
    ----------
    gains : (n,) float64
        Metric of the simpler map less that of the richer one, a tile each.
    least : float
        Standard errors.

    Examples
    --------
    >>> chosen(1, np.array([0.02, 0.03, 0.01, 0.02] * 3), 3.0).kept
    True
    >>> chosen(1, np.array([0.02, -0.03, 0.01, -0.02] * 3), 3.0).kept
    False
    """
    count = len(gains)
    if count < FEWEST:
        return Choice(stage, False, float("nan"), float("nan"), int((gains > 0).sum()), count)
    gain, error = float(gains.mean()), float(gains.std(ddof=1) / np.sqrt(count))
    better = int((gains > 0).sum())
    kept = gain > least * error
    if least >= 0:
        # Tiles better by chance alone: half of them, give or take half the root of their number.
        kept = kept and 2 * better - count > least * np.sqrt(count)
    return Choice(stage, bool(kept), gain, error, better, count)


def held_out_gains(fit: Fit, fixed: Image, objective: Objective, simpler: Params) -> Values:
    """Gains of a richer map over a simpler one in every tile, each fitted without the tile, (n,).

    The tiles form a checkerboard: the map is fitted on its black tiles and judged on the white ones, and
    the other way round. The simpler map has seen all tiles, which favours it a little.

    Parameters
    ----------
    fit : callable
        The stage's search with a fixed image of its own, whose mask hides the tiles held out.
    fixed : Image
        As the stage sees it.
    objective : Objective
        Over the whole of the stage's last level.
    simpler : (p,) float64
        The simpler map as a member of the stage's family.
    """
    scene = objective.scene
    side = max(fixed.grid.extent) / TILES
    tiles = tile_numbers(scene.grid, scene.samples, fixed.grid, side)
    base, gains = objective.pairs(simpler), []
    for parity in (0, 1):
        try:
            richer = objective.pairs(fit(fixed.with_mask(_training(fixed, side, parity))).params)
        except NoOverlapError:
            continue
        for tile in _held_out(tiles, parity):
            pair = [_value(objective.stage.metric, pairs, tile, scene) for pairs in (base, richer)]
            if np.isfinite(pair).all():
                gains.append(pair[0] - pair[1])
    return np.array(gains)


def tile_numbers(grid: Grid, samples: Samples, fixed: Grid, side: float) -> Bins:
    """Number of the tile along each axis in which each sample lies, (n, dim)."""
    indices = fixed.indices(grid.points(samples.all_indices()))
    widths = side / np.array(fixed.spacing[::-1])
    return np.asarray(np.floor((indices + 0.5) / widths), np.int64)


def _training(fixed: Image, side: float, parity: int) -> Mask:
    """The fixed mask less the tiles of one colour."""
    widths = side / np.array(fixed.grid.spacing[::-1])
    places = [
        np.floor((np.arange(n) + 0.5) / w).astype(np.int64)
        for n, w in zip(fixed.grid.shape, widths, strict=True)
    ]
    total = sum(np.meshgrid(*places, indexing="ij", sparse=True))
    shown: Mask = np.asarray(total % 2 != parity)
    return shown if fixed.mask is None else shown & fixed.mask


def _held_out(tiles: Bins, parity: int) -> Iterator[Mask]:
    """Which samples lie in each tile of one colour."""
    low = tiles.min(axis=0)
    sizes = tuple(tiles.max(axis=0) - low + 1)
    numbers = np.ravel_multi_index((tiles - low).T, sizes)
    for number in np.unique(numbers):
        if int(np.sum(low + np.unravel_index(number, sizes))) % 2 == parity:
            yield numbers == number


def _value(metric: Metric, pairs: Pairs, tile: Mask, scene: Scene) -> float:
    """The metric in one tile; infinite where too little of it counts."""
    part = _cut(pairs, tile, scene)
    if part.weight.sum() < COUNTS * len(part.weight):
        return float("inf")
    return float(
        metric.value(replace(part, prepared=metric.prepare(replace(part, moving=np.zeros(0), prepared=None))))
    )


def _cut(pairs: Pairs, tile: Mask, scene: Scene) -> Pairs:
    """The pairs of one tile: of a whole grid, the block of it."""
    shape = None
    if pairs.shape is not None:
        rows = np.flatnonzero(tile)
        block = np.stack(np.unravel_index(rows, scene.samples.shape))
        shape = tuple(int(n) for n in np.ptp(block, axis=1) + 1)
    return replace(
        pairs, fixed=pairs.fixed[tile], moving=pairs.moving[tile], weight=pairs.weight[tile], shape=shape
    )
