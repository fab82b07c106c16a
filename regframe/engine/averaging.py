"""Coarser images by averaging whole blocks of pixels."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from regframe.engine.setting import Setting
from regframe.geometry import Grid
from regframe.image import Image
from regframe.transforms.warp import Chain, Warp
from regframe.types import Volume

COUNTS = 0.5
"""Share of a block's pixels that must count for the block to count."""


def fitting(shape: tuple[int, ...], about: int) -> int:
    """The whole factor that leaves about so many points along the longest axis.

    The nearest one: the least that leaves no more would make 101 points of a frame of 303, for 150.

    Examples
    --------
    >>> fitting((512, 640), 320), fitting((240, 303), 150), fitting((3, 4), 16)
    (2, 2, 1)
    """
    return max(1, int(max(shape) / about + 0.5))


def reduction(fixed: Grid, moving: Grid, magnification: float) -> int:
    """Whole number of moving pixels to a fixed grid point, at least 1."""
    return max(1, int(min(fixed.spacing) * magnification / max(moving.spacing) + 0.25))


def magnification(warp: Warp | Chain) -> float:
    """Moving lengths over fixed ones, about; of maps that are not affine in the fixed image's middle."""
    affine = warp.as_affine()
    if affine is not None:
        return float(abs(np.linalg.det(affine.matrix)) ** (1.0 / affine.dim))
    grid = warp.frame.grid
    steps = min(grid.spacing) / 2 * np.eye(grid.dim)
    slopes = (warp(grid.centre + steps) - warp(grid.centre - steps)) / min(grid.spacing)
    return float(abs(np.linalg.det(slopes)) ** (1.0 / grid.dim))


class Pyramid:
    """Two images, and their averages as they are asked for."""

    def __init__(self, fixed: Image, moving: Image) -> None:
        self.images = fixed, moving
        self._made: dict[tuple[int, int], Image] = {}

    def averaged(self, which: int, factor: int) -> Image:
        """The fixed (0) or moving (1) image averaged over `factor` pixels along each axis."""
        if (which, factor) not in self._made:
            self._made[which, factor] = averaged(self.images[which], factor)
        return self._made[which, factor]


def fitted(
    pyramid: Pyramid, setting: Setting, warp: Warp | Chain, about: int
) -> tuple[tuple[Image, Image], Setting]:
    """Both images averaged until the domain has about so many points on its longest axis, and that domain.

    The moving image is averaged to about the same spacing under a warp, so that both lose the same detail.
    """
    fixed, moving = pyramid.images
    domain, factor = setting.domain, fitting(setting.domain.shape, about)
    below = pyramid.averaged(0, factor)
    coarse = below.grid if domain is fixed.grid else domain.coarsen(factor)
    above = pyramid.averaged(1, reduction(coarse, moving.grid, magnification(warp)))
    return (below, above), replace(setting, domain=coarse)


def averaged(image: Image, factor: int) -> Image:
    """The image of means over blocks of `factor` pixels along each axis, those under the mask alone.

    Blocks lie about the image's middle; pixels at the border that fill no block are left out.

    Examples
    --------
    >>> averaged(Image.of_array(np.arange(12.0).reshape(2, 6)), 2).values
    array([[3.5, 5.5, 7.5]])
    """
    if factor == 1:
        return image
    grid = image.grid
    shape = tuple(max(n // factor, 1) for n in grid.shape)
    widths = tuple(min(factor, n) for n in grid.shape)
    first = tuple((n - m * w) // 2 for n, m, w in zip(grid.shape, shape, widths, strict=True))
    inner = tuple(slice(f, f + m * w) for f, m, w in zip(first, shape, widths, strict=True))
    middle = np.array([f + (w - 1) / 2 for f, w in zip(first, widths, strict=True)])
    origin = grid.points(middle[None])[0]
    spacing = tuple(s * w for s, w in zip(grid.spacing, reversed(widths), strict=True))
    coarse = Grid(shape, spacing, tuple(map(float, origin)), grid.direction)
    if image.mask is None:
        values = _blocks(np.asarray(image.values)[inner], widths) / np.prod(widths)
        return Image(np.asarray(values, np.float64), coarse, name=image.name)
    counted = image.mask[inner]
    mass = _blocks(counted, widths)
    total = _blocks(np.where(counted, image.values[inner], 0.0), widths)
    mask = mass >= COUNTS * np.prod(widths)
    if not mask.any():
        mask = mass > 0
    return Image(total / np.maximum(mass, 1.0), coarse, mask, name=image.name)


def _blocks(values: NDArray[np.generic], widths: tuple[int, ...]) -> Volume:
    """Sums over blocks, of an array that they divide."""
    found = np.asarray(values, np.float64)
    # Slice by slice along one axis after the other: a sum over several axes takes numpy five times as long.
    for axis, width in enumerate(widths):
        before = (slice(None),) * axis
        total = found[(*before, slice(0, None, width))].copy()
        for first in range(1, width):
            total += found[(*before, slice(first, None, width))]
        found = total
    return found
