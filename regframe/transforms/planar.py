"""Homographies between lenses, run by the kernels of `kernels.planar`."""

import numpy as np

from regframe.kernels import planar as kernels
from regframe.kernels.sharing import BLOCKS, share
from regframe.transforms.homography import Homography
from regframe.transforms.lens import Lens
from regframe.types import Params, Points, Values

Parts = tuple[Lens, Homography, Lens]


def place(parts: Parts, points: Points) -> Points:
    """Moving points of (n, 2) fixed points; `kernels.planar.FAR` where there is no image."""
    given = np.ascontiguousarray(points, np.float64)
    out = np.empty_like(given)
    share(kernels.place, len(given), _numbers(parts), given, out)
    return out


def pull(parts: Parts, points: Points, forces: Points) -> Params:
    """Sum of ``forces . d map / d params``, (12,): matrix, translation, slant, fixed and moving k1 and k2."""
    partial = np.zeros((BLOCKS, 12))
    given = (np.ascontiguousarray(one, np.float64) for one in (points, forces))
    share(kernels.pull, BLOCKS, _numbers(parts), *given, partial)
    total: Params = partial[0]
    for block in partial[1:]:
        total = total + block
    return total


def _numbers(parts: Parts) -> Values:
    fixed, plane, moving = parts
    lenses = [(*lens.centre, lens.radius, *lens.pair, lens.limit) for lens in (fixed, moving)]
    middle = (*plane.matrix.ravel(), *plane.translation, *plane.slant, *plane.centre)
    return np.array([*lenses[0], *middle, *lenses[1]])
