"""Images: values on a grid, with an optional mask."""

from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from regframe.errors import GeometryError, ImageError
from regframe.geometry import Grid
from regframe.types import Mask

Pixels = NDArray[np.float32] | NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Image:
    """Finite grey values on a grid.

    Values are float32 or float64. As in ITK, values interpolated in a float32 image are rounded to
    float32 before a metric sees them, so integer grey levels stay exactly on their levels.

    Parameters
    ----------
    values : (ny, nx) or (nz, ny, nx) float32 or float64
    grid : Grid
    mask : bool array of the same shape, optional
        True where pixels count.
    raw : array, optional
        The pixels as they were stored (any number type, colour as a last axis), for writing results
        at the original depth.
    name : str
        What error messages and reports call the image.

    Raises
    ------
    ImageError
        Values that are not finite numbers, or an empty image.
    GeometryError
        Shapes that do not fit, or an empty mask.
    """

    values: Pixels
    grid: Grid
    mask: Mask | None = None
    raw: NDArray[Any] | None = None
    name: str = "image"

    def __post_init__(self) -> None:
        _check_values(self.values, self.grid, self.name)
        if self.mask is not None:
            _check_mask(self.mask, self.grid, self.name)

    @classmethod
    def of_array(cls, array: NDArray[Any], *, name: str = "image") -> "Image":
        """An image of a numpy array on a camera grid: pixel units, spacing 1.

        Parameters
        ----------
        array : (ny, nx), (nz, ny, nx), or (ny, nx, 3 or 4) for colour
            Colour becomes grey by `grey`.
        name : str
        """
        raw = np.asarray(array)
        values = grey(raw) if is_colour(raw) else raw
        return cls(as_pixels(values, name), Grid.of_shape(values.shape), raw=raw, name=name)

    @property
    def dim(self) -> int:
        """Number of axes."""
        return self.grid.dim

    @property
    def rounds(self) -> bool:
        """Whether interpolated values are rounded to float32, as ITK does for float32 images."""
        return self.values.dtype == np.float32

    def range(self) -> tuple[float, float]:
        """Smallest and largest value under the mask."""
        counted = self.values if self.mask is None else self.values[self.mask]
        return float(counted.min()), float(counted.max())

    def with_values(self, values: Pixels) -> "Image":
        """The same image with other values."""
        return replace(self, values=values)

    def with_rounded(self, values: NDArray[Any]) -> "Image":
        """The same image with other values, rounded to the float type that it has."""
        return replace(self, values=cast("Pixels", np.ascontiguousarray(values, self.values.dtype)))

    def with_mask(self, mask: Mask | None) -> "Image":
        """The same image with another mask."""
        return replace(self, mask=mask)


def is_colour(array: NDArray[Any]) -> bool:
    """Whether an array is a 2-D colour image: three axes, the last of length 3 or 4."""
    return array.ndim == 3 and array.shape[-1] in (3, 4)


def grey(colour: NDArray[Any]) -> NDArray[np.float32]:
    """Luma of a colour image by ITU-R BT.601: 0.299 R + 0.587 G + 0.114 B; alpha is ignored.

    Parameters
    ----------
    colour : (ny, nx, 3 or 4) array, red first

    Returns
    -------
    (ny, nx) float32, in the units of the input
    """
    luma = np.zeros(colour.shape[:-1])
    for channel, weight in enumerate((0.299, 0.587, 0.114)):
        luma += np.multiply(colour[..., channel], weight, dtype=np.float64)
    return luma.astype(np.float32)


def as_pixels(array: NDArray[Any], name: str = "image") -> Pixels:
    """Numbers as float32 where that is exact for their type, else float64."""
    if array.dtype.kind not in "uifb":
        message = f"{name}: pixels must be real numbers. Got type {array.dtype}. Convert them first."
        raise ImageError(message)
    small = array.dtype.kind == "b" or (array.dtype.kind in "ui" and array.dtype.itemsize <= 2)
    if small or array.dtype in (np.float16, np.float32):
        return np.ascontiguousarray(array, np.float32)
    return np.ascontiguousarray(array, np.float64)


def _check_values(values: Pixels, grid: Grid, name: str) -> None:
    if values.dtype not in (np.float32, np.float64):
        message = f"{name}: values must be float32 or float64. Got {values.dtype}. Use as_pixels()."
        raise ImageError(message)
    if values.shape != grid.shape:
        message = f"{name}: values of shape {values.shape} do not fit a grid of {grid.shape}."
        raise GeometryError(message)
    if grid.dim not in (2, 3):
        message = f"{name}: images have 2 or 3 axes. Got {grid.dim}: shape {grid.shape}."
        raise GeometryError(message)
    if values.size == 0:
        message = f"{name}: the image is empty, shape {values.shape}."
        raise ImageError(message)
    bad = int(values.size - np.count_nonzero(np.isfinite(values)))
    if bad:
        message = (
            f"{name}: {bad} of {values.size} pixels are NaN or infinite. "
            "Replace them (numpy.nan_to_num), or set them to a number and mask them out."
        )
        raise ImageError(message)


def _check_mask(mask: Mask, grid: Grid, name: str) -> None:
    if mask.shape != grid.shape:
        message = f"{name}: the mask has shape {mask.shape}, the image {grid.shape}. They must be equal."
        raise GeometryError(message)
    if mask.dtype != np.bool_:
        message = f"{name}: a mask holds True and False. Got {mask.dtype}. Write mask != 0."
        raise GeometryError(message)
    if not mask.any():
        message = f"{name}: the mask is empty, no pixel counts. Check that it is not inverted."
        raise GeometryError(message)
