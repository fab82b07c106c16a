"""Directions of edges as complex numbers, on a small grid, and how well those of two images coincide.

A gradient (gx, gy) becomes (gx + i gy)**2 / (|g|**2 + eta**2): its angle is twice the edge's, so that an
edge counts the same whichever side is brighter, and its length says how clear the edge is. The real part of
the product of two such numbers, one conjugated, is the cosine of twice the angle between two edges. Summed it
is, up to a constant, the measure of normalised gradient fields of Haber and Modersitzki ("Intensity gradient
based registration and fusion of multi-modal images", Methods of Information in Medicine 46, 2007), and its
sums over all shifts are a convolution.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from regframe.catalog import INTERPOLATORS
from regframe.engine.resampling import resample
from regframe.engine.scene import smoothed
from regframe.geometry import AffineMap, Frame, Grid
from regframe.image import Image
from regframe.transforms.warp import Chain, Warp
from regframe.types import Mask, Volume

if TYPE_CHECKING:
    from regframe.interpolators.base import Interpolator

WIDTH = 320
"""Pixels across at which edges are compared: coarse enough to be quick, fine enough for a pixel or two."""
SMOOTHING = 1.2  # pixels of the small grid
NEIGHBOURHOOD = 8.0  # pixels over which an edge's strength is judged
WEAK, EMPTY = 0.7, 0.15  # shares of the local and of the mean strength below which an edge counts little
RIM = 3  # pixels beside missing ones, whose gradients are none of the image

Field = NDArray[np.complex64]
"""(ny, nx), twice the edge's direction as an angle, its clearness as a length."""


@dataclass(frozen=True, eq=False)
class Edges:
    """The directions of an image's edges, 0 where there is no image.

    Parameters
    ----------
    field : (ny, nx) complex64
    weight : (ny, nx) float32
        1 where there is an image, else 0.
    """

    field: Field
    weight: NDArray[np.float32]

    def centred(self) -> Field:
        """The field without its mean: what an image of only horizontal lines shares with every other one."""
        mean = self.field.sum() / max(float(self.weight.sum()), 1.0)
        found: Field = (self.field - mean * self.weight).astype(np.complex64)
        return found

    def part(self, box: tuple[slice, slice]) -> "Edges":
        """The edges within a box."""
        return Edges(self.field[box], self.weight[box])


def working_grid(grid: Grid) -> Grid:
    """The fixed grid made coarse, about 320 pixels across."""
    return grid.coarsen(max(1, round(max(grid.shape) / WIDTH)))


def pair(fixed: Image, moving: Image, warp: Warp | Chain) -> tuple[Grid, Edges, Edges]:
    """Edges of both images on one small grid, the moving ones where a warp puts them.

    Parameters
    ----------
    fixed, moving : Image
        In 2-D.
    warp : Warp or Chain

    Returns
    -------
    grid : Grid
        The small grid.
    fixed, moving : Edges
    """
    grid = working_grid(fixed.grid)
    reach = SMOOTHING * grid.spacing[0]
    stay = Warp.of_affine(AffineMap.identity(fixed.dim), Frame.about_centre(fixed.grid))
    return (
        grid,
        edges(*_seen(smoothed(fixed, reach), grid, stay)),
        edges(*_seen(smoothed(moving, reach * stretch(warp, fixed.grid)), grid, warp)),
    )


def stretch(warp: Warp | Chain, grid: Grid) -> float:
    """Moving length of a unit of fixed length, in the middle of the grid."""
    step = 0.5 * min(grid.spacing)
    steps = step * np.concatenate([np.eye(grid.dim), -np.eye(grid.dim)])
    ends = warp(grid.centre + steps)
    matrix = (ends[: grid.dim] - ends[grid.dim :]) / (2.0 * step)
    size = float(np.abs(np.linalg.det(matrix))) ** (1.0 / grid.dim)
    return size if np.isfinite(size) and size > 0.0 else 1.0


def edges(values: Volume, inside: Mask) -> Edges:
    """The edges of an image where it exists.

    Parameters
    ----------
    values : (ny, nx) float64
    inside : (ny, nx) bool
    """
    from scipy import ndimage

    if not inside.any():
        return Edges(np.zeros(values.shape, np.complex64), np.zeros(values.shape, np.float32))
    filled = np.where(inside, values, values[inside].mean()).astype(np.float32)
    down, across = np.gradient(filled)
    strength = np.hypot(across, down)
    counted = ndimage.binary_erosion(inside, iterations=RIM, border_value=1)
    strength[~counted] = 0.0
    local = ndimage.gaussian_filter(strength, NEIGHBOURHOOD, truncate=3.0)
    smallest = max(1e-12 * float(strength.max()) ** 2, 1e-30)
    least = (WEAK * local) ** 2 + (EMPTY * strength.mean()) ** 2 + smallest
    field = (across + 1j * down) ** 2 / (strength**2 + least)
    return Edges((field * counted).astype(np.complex64), counted.astype(np.float32))


def _seen(image: Image, grid: Grid, warp: Warp | Chain) -> tuple[Volume, Mask]:
    """An image on the small grid, and where it is seen and counts."""
    linear: Interpolator = INTERPOLATORS.build("linear")
    values, inside = resample(image.values, image.grid, grid, warp, linear)
    if image.mask is not None:
        marked = image.mask.astype(np.float64)
        inside &= resample(marked, image.grid, grid, warp, INTERPOLATORS.build("nearest"))[0] > 0
    return values, inside
