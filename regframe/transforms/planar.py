"""Homographies between lenses, run by the kernels of `kernels.planar`."""

import numpy as np

from regframe.kernels import planar as kernels
from regframe.transforms.homography import Homography, places, pulls
from regframe.transforms.lens import Lens
from regframe.types import Params, Points, Values

Parts = tuple[Lens, Homography, Lens]


def place(parts: Parts, points: Points) -> Points:
    """Moving points of (n, 2) fixed points; `kernels.planar.FAR` where there is no image."""
    return places(kernels.place, _numbers(parts), points)


def pull(parts: Parts, points: Points, forces: Points) -> Params:
    """Sum of ``forces . d map / d params``, (12,): matrix, translation, slant, fixed and moving k1 and k2."""
    return pulls(kernels.pull, _numbers(parts), points, forces, 12)


def _numbers(parts: Parts) -> Values:
    fixed, plane, moving = parts
    lenses = [(*lens.centre, lens.radius, *lens.pair, lens.limit) for lens in (fixed, moving)]
    middle = (*plane.matrix.ravel(), *plane.translation, *plane.slant, *plane.centre)
    return np.array([*lenses[0], *middle, *lenses[1]])
