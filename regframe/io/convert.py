"""Images to SimpleITK and back."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from regframe.errors import ImageError
from regframe.geometry import Grid
from regframe.image import Image, as_pixels, grey

if TYPE_CHECKING:
    import SimpleITK as sitk

CHANNELS = (1, 3, 4)
"""Values a pixel that can be read: grey, colour, colour with alpha."""


def from_sitk(image: "sitk.Image", *, name: str = "image") -> Image:
    """A SimpleITK image with its geometry; colour becomes grey.

    A last axis of one point is dropped, as single slices and series of one volume have it.

    Parameters
    ----------
    image : SimpleITK.Image
        2-D or 3-D; colour in 2-D.
    name : str

    Returns
    -------
    Image

    Raises
    ------
    ImageError
        Too many axes, values that are not grey or colour, or not finite.

    Examples
    --------
    >>> import SimpleITK as sitk
    >>> image = sitk.Image([4, 3], sitk.sitkUInt16)
    >>> image.SetSpacing([0.5, 2.0])
    >>> from_sitk(image).grid.spacing
    (0.5, 2.0)
    """
    import SimpleITK as sitk

    channels = image.GetNumberOfComponentsPerPixel()
    grid = _grid(image, name)
    if channels not in CHANNELS or (channels > 1 and grid.dim != 2):
        message = (
            f"{name}: {channels} values a pixel in {grid.dim}-D are neither grey nor a colour picture. "
            "Take one of them (SimpleITK.VectorIndexSelectionCast)."
        )
        raise ImageError(message)
    stored = sitk.GetArrayFromImage(image)
    raw = stored.reshape(grid.shape if channels == 1 else (*grid.shape, channels))
    values = raw if channels == 1 else grey(raw)
    return Image(as_pixels(values, name), grid, raw=raw, name=name)


def to_sitk(image: Image) -> "sitk.Image":
    """The values of an image as a SimpleITK image, float32 or float64, with its geometry.

    Examples
    --------
    >>> image = Image.of_array(np.zeros((3, 4), np.uint8))
    >>> to_sitk(image).GetSize()
    (4, 3)
    """
    return array_to_sitk(image.values, image.grid)


def array_to_sitk(array: NDArray[Any], grid: Grid) -> "sitk.Image":
    """Pixels on a grid as a SimpleITK image; one axis more than the grid's holds colour."""
    import SimpleITK as sitk

    image = sitk.GetImageFromArray(array, isVector=array.ndim > grid.dim)
    image.SetSpacing(grid.spacing)
    image.SetOrigin(grid.origin)
    image.SetDirection([entry for row in grid.direction for entry in row])
    return image


def _grid(image: "sitk.Image", name: str) -> Grid:
    size, spacing, origin = image.GetSize(), image.GetSpacing(), image.GetOrigin()
    direction = np.reshape(image.GetDirection(), (len(size), len(size)))
    dim = _axes(size, direction)
    if dim > 3:
        message = (
            f"{name}: images have 2 or 3 axes. Got {dim}, of size {size} (x first). "
            "Take one volume of the series (SimpleITK: image[..., 0])."
        )
        raise ImageError(message)
    if dim == 3 and size[2] == 1:
        message = (
            f"{name}: a single slice that is tilted in space, direction {direction.tolist()}, is neither a "
            "plane nor a volume. Make it a 2-D image (SimpleITK: image[:, :, 0]), or give the whole volume."
        )
        raise ImageError(message)
    rows = tuple(tuple(map(float, row[:dim])) for row in direction[:dim])
    return Grid(tuple(map(int, size[dim - 1 :: -1])), tuple(spacing[:dim]), tuple(origin[:dim]), rows)


def _axes(size: Sequence[int], direction: NDArray[Any]) -> int:
    """Number of axes without those of one point at the end that stand upright on the others."""
    dim = len(size)
    while dim > 2 and size[dim - 1] == 1:
        last = dim - 1
        if np.any(direction[last, :last]) or np.any(direction[:last, last]):
            break
        dim = last
    return dim
