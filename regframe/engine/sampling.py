"""Which points of a level's grid are compared: all, regular or random, with ITK's draws."""

import numpy as np
from numpy.typing import NDArray

from regframe.geometry import Grid
from regframe.interpolators.base import Samples
from regframe.preset import Level
from regframe.types import Points

WORD = 2.0**32


def draw(level: Level, grid: Grid, seed: int) -> tuple[Samples, int]:
    """Samples of a level, and the seed for the next level.

    Regular takes every ceil(1 / fraction)-th point in scan order; random takes points with replacement.
    Both move each point by a normal deviate of a third of the spacing along each physical axis, and keep
    coordinates in float32: ITK's procedure, with its generator and order of draws.

    Parameters
    ----------
    level : Level
    grid : Grid
        The level's shrunk grid.
    seed : int

    Returns
    -------
    samples : Samples
    next_seed : int
    """
    if level.sampling == "all":
        return Samples(grid.shape), seed
    if level.sampling == "regular":
        chosen = np.arange(0, grid.size, int(np.ceil(1.0 / level.fraction)))
        used = 1
    else:
        count = int(float(np.float32(grid.size)) * level.fraction)
        # A first seed jitters, a second one chooses.
        chosen = (_open(_words(seed + 1, max(count, 1))) * (grid.size - 0.5)).astype(np.int64)
        used = 2
    points = _jittered(grid, chosen, seed)
    return Samples(grid.shape, grid.indices(points)), seed + used


def _words(seed: int, count: int) -> NDArray[np.float64]:
    """32-bit words of the Mersenne twister after Knuth's plain initialisation."""
    source = np.random.RandomState(seed % 2**32)._bit_generator
    return np.asarray(source.random_raw(count), np.float64)


def _open(words: NDArray[np.float64]) -> NDArray[np.float64]:
    return (words + 0.5) / WORD


def _jittered(grid: Grid, chosen: NDArray[np.int64], seed: int) -> Points:
    """Centres of the chosen points, each moved by its deviates, in float32 precision."""
    indices = np.stack(np.unravel_index(chosen, grid.shape), axis=1).astype(np.float64)
    scaled = grid.index_to_point.matrix
    points = np.broadcast_to(np.array(grid.origin, np.float32), indices.shape)
    for column in range(grid.dim):
        step = scaled[:, column] * indices[:, grid.dim - 1 - column, None]
        points = (points.astype(np.float64) + step).astype(np.float32)
    words = _words(seed, 2 * indices.size).reshape(-1, 2)
    normal = np.sqrt(-2.0 * np.log(1.0 - _open(words[:, 0]))) * np.cos(2.0 * np.pi * (words[:, 1] / WORD))
    moved = points.astype(np.float64) + normal.reshape(indices.shape) * np.array(grid.spacing) / 3.0
    return np.asarray(moved.astype(np.float32), np.float64)
