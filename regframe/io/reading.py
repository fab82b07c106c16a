"""Images from files and from memory."""

import hashlib
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from regframe.errors import GeometryError, ImageError
from regframe.geometry import Grid
from regframe.image import Image
from regframe.io import decoding
from regframe.io.convert import from_sitk
from regframe.io.writing import is_there
from regframe.types import Mask

if TYPE_CHECKING:
    import SimpleITK as sitk

CAMERA = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff")
"""Formats read on a grid in pixels: what they say of size in the world is not believed."""

GEOMETRIC = (".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz")
"""Formats that tell origin, spacing and direction."""

LOSSY = (".jpg", ".jpeg")

_ELSEWHERE = 1e-3  # a mask's corners may lie this far from the image's, in pixels


def read(path: str | Path, *, name: str | None = None) -> Image:
    """Read an image file.

    Camera formats (PNG, JPEG, BMP, TIFF) get a grid in pixels, spacing 1, whatever resolution they claim,
    and pixels in the order they are stored, whatever turn their EXIF data wish for. NRRD, MetaImage and
    NIfTI keep origin, spacing and direction. Colour becomes grey by `regframe.image.grey`; `raw` keeps
    the pixels as they were stored.

    Parameters
    ----------
    path : path
    name : str, optional
        What messages and reports call the image; the path when left out.

    Returns
    -------
    Image

    Raises
    ------
    ImageError
        The file is missing, damaged, of an unknown kind, or holds pixels that are not finite numbers.

    Examples
    --------
    >>> import numpy as np
    >>> from regframe import Grid, write
    >>> pixels = np.arange(12, dtype=np.uint16).reshape(3, 4)
    >>> write(pixels, Grid.of_shape((3, 4)), "frame.png")
    >>> read("frame.png").values[2]
    array([ 8.,  9., 10., 11.], dtype=float32)
    """
    place = Path(path)
    called = name or str(path)
    _check_file(place, called)
    if place.name.lower().endswith(CAMERA):
        return Image.of_array(decoding.picture(place, called), name=called)
    return from_sitk(decoding.volume(place, called), name=called)


def read_mask(path: str | Path, grid: Grid) -> Mask:
    """Read a mask: True where a file's pixels differ from 0.

    Parameters
    ----------
    path : path
    grid : Grid
        The image's; the mask must have its shape and, in formats that tell it, its place.

    Returns
    -------
    bool array of ``grid.shape``

    Raises
    ------
    ImageError
        The file cannot be read, or its format blurs the mask's border.
    GeometryError
        The mask has another shape, lies elsewhere, or is empty.

    Examples
    --------
    >>> import numpy as np
    >>> from regframe import Grid, write
    >>> grid = Grid.of_shape((3, 4))
    >>> write(np.eye(3, 4) > 0, grid, "mask.png")
    >>> read_mask("mask.png", grid)[1]
    array([False,  True, False, False])
    """
    if str(path).lower().endswith(LOSSY):
        message = f"{path}: JPEG blurs a mask's border, so pixels near it are not 0. Save the mask as PNG."
        raise ImageError(message)
    image = read(path)
    if image.grid.shape != grid.shape:
        message = (
            f"{path}: the mask has shape {image.grid.shape}, the image {grid.shape}. They must be equal."
        )
        raise GeometryError(message)
    if str(path).lower().endswith(GEOMETRIC):
        off = np.abs(grid.indices(image.grid.corners()) - grid.corner_indices()).max()
        if off > _ELSEWHERE:
            message = (
                f"{path}: the mask's corners lie up to {off:.3g} pixels from the image's. "
                "Resample the mask on the image's grid."
            )
            raise GeometryError(message)
    mask: Mask = image.values != 0
    if not mask.any():
        message = f"{path}: the mask is empty, every pixel is 0. Check that it is not inverted."
        raise GeometryError(message)
    return mask


def coerce(thing: "str | Path | NDArray[Any] | sitk.Image | Image", name: str) -> Image:
    """An image of whatever can be taken for one.

    Parameters
    ----------
    thing : path, numpy array, SimpleITK image or Image
        Arrays get a grid in pixels; SimpleITK images keep their geometry; an Image is returned as it is.
    name : str
        What messages call it; a file is called by its path instead.

    Raises
    ------
    ImageError
        It cannot be read, or is none of these.
    GeometryError
        An array of more than three axes, or less than two.

    Examples
    --------
    >>> import numpy as np
    >>> coerce(np.eye(3), "fixed").grid.shape
    (3, 3)
    """
    if isinstance(thing, Image):
        return thing
    if isinstance(thing, str | os.PathLike):
        return read(Path(thing))
    if isinstance(thing, np.ndarray):
        return Image.of_array(thing, name=name)
    # Asked by name, so that SimpleITK is imported only for those who use it already.
    if type(thing).__module__.partition(".")[0] == "SimpleITK":
        return from_sitk(thing, name=name)
    message = (
        f"{name}: an image is a path, a numpy array, a SimpleITK image or a regframe.Image. "
        f"Got {type(thing).__name__}. Make it an array (numpy.asarray)."
    )
    raise ImageError(message)


def digest(image: Image) -> str:
    """SHA-256 of an image's pixels, as used and as stored, and of its geometry.

    Examples
    --------
    >>> import numpy as np
    >>> digest(Image.of_array(np.eye(3)))[:8] == digest(Image.of_array(np.eye(3)))[:8]
    True
    """
    grid = image.grid
    whole = hashlib.sha256(repr((grid.shape, grid.spacing, grid.origin, grid.direction)).encode())
    for pixels in (image.values, image.raw):
        if pixels is not None:
            whole.update(f"{pixels.dtype.str} {pixels.shape}".encode())
            whole.update(np.ascontiguousarray(pixels).data)
    return whole.hexdigest()


def _check_file(path: Path, name: str) -> None:
    if not is_there(path):
        message = f"{name}: there is no such file. Check the path."
        raise ImageError(message)
    if path.is_dir():
        message = f"{name}: this is a folder. Name an image file in it."
        raise ImageError(message)
    if not path.name.lower().endswith((*CAMERA, *GEOMETRIC)):
        known = ", ".join((*CAMERA, *GEOMETRIC))
        message = f"{name}: no image format has the suffix {path.suffix!r}. Known: {known}."
        raise ImageError(message)
    try:
        with path.open("rb") as file:
            empty = not file.read(1)
    except OSError as error:
        message = f"{name}: the file cannot be opened: {error.strerror}. Check its permissions."
        raise ImageError(message) from error
    if empty:
        message = f"{name}: the file is empty. Copy it again."
        raise ImageError(message)
