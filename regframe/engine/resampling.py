"""Images on other grids: what a found warp does to the pixels that were given."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from regframe.catalog import INTERPOLATORS
from regframe.geometry import Grid
from regframe.image import Image, is_colour
from regframe.interpolators.base import Interpolator, Samples
from regframe.transforms.warp import Chain, Warp
from regframe.types import Mask, Volume


def align(
    image: Image,
    grid: Grid,
    warp: Warp | Chain,
    interpolator: Interpolator | None = None,
    fill: float = 0.0,
) -> NDArray[Any]:
    """The image's stored pixels on another grid, colour and number type kept.

    Integers are rounded to the nearest and clipped to their type's range.

    Parameters
    ----------
    image : Image
        The moving image.
    grid : Grid
        Where values are wanted, usually the fixed image's grid.
    warp : Warp or Chain
        Takes points of `grid` to points of `image`, physical, x first.
    interpolator : Interpolator, optional
        Cubic splines when left out; labels want ``nearest``.
    fill : float
        What pixels outside the image get.

    Returns
    -------
    array of ``grid.shape``, with a last axis of channels for colour images

    Examples
    --------
    >>> from regframe.geometry import Frame
    >>> from regframe.transforms.translation import Translation
    >>> image = Image.of_array(np.arange(9, dtype=np.uint8).reshape(3, 3))
    >>> warp = Warp(Translation(), np.array([1.0, 0.0]), Frame.about_centre(image.grid))
    >>> align(image, image.grid, warp)
    array([[1, 2, 0],
           [4, 5, 0],
           [7, 8, 0]], dtype=uint8)
    """
    raw = image.values if image.raw is None else image.raw
    way = interpolator or INTERPOLATORS.build("bspline")
    coloured = raw.ndim == grid.dim + 1 and is_colour(raw)
    channels = [raw[..., i] for i in range(raw.shape[-1])] if coloured else [raw]
    aligned = [_as_type(*resample(one, image.grid, grid, warp, way), raw.dtype, fill) for one in channels]
    return np.stack(aligned, axis=-1) if coloured else aligned[0]


def resample(
    values: NDArray[Any], source: Grid, grid: Grid, warp: Warp | Chain, interpolator: Interpolator
) -> tuple[Volume, Mask]:
    """Values of one channel on another grid, and where there are any.

    Parameters
    ----------
    values : (ny, nx) or (nz, ny, nx) array on `source`
    source, grid : Grid
        Where values are, and where they are wanted.
    warp : Warp or Chain
        Takes points of `grid` to points of `source`.
    interpolator : Interpolator

    Returns
    -------
    values : float64 of ``grid.shape``, 0 outside
    inside : bool of ``grid.shape``
    """
    coefficients = interpolator.prepare(np.ascontiguousarray(values, dtype=np.float64))
    affine = warp.as_affine()
    if affine is None:
        points = warp(grid.points(grid.all_indices()))
        samples, index_map = Samples(grid.shape, source.indices(points)), None
    else:
        samples = Samples(grid.shape)
        index_map = (source.point_to_index @ affine @ grid.index_to_point).reversed_axes()
    found, weights = interpolator.resample(coefficients, samples, index_map)
    return found.reshape(grid.shape), weights.reshape(grid.shape) > 0


def _as_type(values: Volume, inside: Mask, dtype: "np.dtype[Any]", fill: float) -> NDArray[Any]:
    filled = np.where(inside, values, fill)
    if dtype.kind == "b":
        return filled >= 0.5
    if dtype.kind in "ui":
        limits = np.iinfo(dtype)
        return np.clip(np.rint(filled), limits.min, limits.max).astype(dtype)
    return filled.astype(dtype)
