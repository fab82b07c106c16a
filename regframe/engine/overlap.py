"""How much of two frames meets under a map."""

import numpy as np

from regframe.engine.averaging import magnification
from regframe.geometry import Grid
from regframe.transforms.warp import Chain, Warp
from regframe.types import Points

LATTICE = 21
"""Points along each axis that stand for a grid."""


def overlap(warp: Warp | Chain, fixed: Grid, moving: Grid) -> float:
    """Share of the smaller of both fields of view that both images show."""
    return shares(warp, fixed, moving)[0]


def shares(warp: Warp | Chain, fixed: Grid, moving: Grid) -> tuple[float, float]:
    """What both images show, as a share of the smaller of both fields of view, and of the fixed one.

    Parameters
    ----------
    warp : Warp or Chain
    fixed, moving : Grid
    """
    met = warp(spread(fixed))
    here = met[np.isfinite(met).all(axis=1)]
    of_fixed = float(moving.inside(moving.indices(here)).sum()) / len(met)
    # In moving pixels the fixed image is this many times as large as the moving one.
    ratio = magnification(warp) ** fixed.dim * float(np.prod(fixed.extent) / np.prod(moving.extent))
    return min(of_fixed * max(ratio, 1.0), 1.0) if np.isfinite(ratio) else of_fixed, of_fixed


def spread(grid: Grid) -> Points:
    """Points of a grid, evenly apart, its corners among them."""
    axes = [np.linspace(0.0, n - 1.0, LATTICE) for n in grid.shape]
    return grid.points(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, grid.dim))
