"""Image files to stored pixels: SimpleITK reads them, and what it reads wrongly is caught here."""

import re
import warnings
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from regframe.errors import ImageError
from regframe.io import nifti, tiff
from regframe.io.muted import muted

if TYPE_CHECKING:
    import SimpleITK as sitk
    from PIL import Image as Pillow

_DAMAGED_JPEG = ("Premature end of JPEG", "premature end of data", "bad Huffman code")
# Named, because SimpleITK's own choice does not know all suffixes in capital letters.
_READERS = {
    ".nrrd": "NrrdImageIO",
    ".nhdr": "NrrdImageIO",
    ".mha": "MetaImageIO",
    ".mhd": "MetaImageIO",
    ".nii": "NiftiImageIO",
}
_NO_REASON = re.compile(r"^(Exception thrown|Filename|Reason: |WARNING: In|HDF5-DIAG|\s)|^$")
_CLUTTER = re.compile(r"^(ITK ERROR: |sitk::ERROR: |\[nrrd\] )|\w+\(0x[0-9a-f]+\): ")


def picture(path: Path, name: str) -> NDArray[Any]:
    """The stored pixels of a camera's file.

    Parameters
    ----------
    path : Path
        PNG, JPEG, BMP or TIFF.
    name : str

    Returns
    -------
    (ny, nx), (ny, nx, 3 or 4) for colour, or (pages, ny, nx) array
        A palette's colours and 1-bit pixels (0 or 255) are written out; grey loses its alpha.

    Raises
    ------
    ImageError
        The file is no image, or damaged.
    """
    with path.open("rb") as file:
        magic = file.read(4)
    if magic in tiff.MAGICS:
        return _tiff(path, name)
    # SimpleITK accepts truncated BMP files, and makes colour of grey ones.
    if magic[:2] == b"BM":
        return _with_pillow(path, name)
    image, said = _attempt(path)
    damage = [line for line in said if any(sign in line for sign in _DAMAGED_JPEG)]
    if damage:
        message = f"{name}: the file is damaged or truncated ({damage[0]}). Copy it again."
        raise ImageError(message)
    if image is None:
        # Grey with alpha, and files under another format's suffix.
        return _with_pillow(path, name)
    import SimpleITK as sitk

    pixels: NDArray[Any] = sitk.GetArrayFromImage(image)
    return pixels


def volume(path: Path, name: str) -> "sitk.Image":
    """A medical file's image, with its geometry.

    Parameters
    ----------
    path : Path
        NRRD, MetaImage or NIfTI.
    name : str

    Raises
    ------
    ImageError
        The file is no image, or damaged.
    """
    suffix = path.suffix.lower()
    if suffix == ".nii":
        nifti.check(path, name)
    if suffix != ".gz":
        return _read(path, name, _READERS[suffix])
    with TemporaryDirectory() as folder:
        plain = Path(folder) / "unpacked.nii"
        nifti.unpack(path, plain, name)
        nifti.check(plain, name)
        return _read(plain, name, _READERS[".nii"])


def _tiff(path: Path, name: str) -> NDArray[Any]:
    import SimpleITK as sitk

    data = path.read_bytes()
    plan = tiff.plan(data, name)
    if plan.data is None:
        return plan.restore(sitk.GetArrayFromImage(_read(path, name)), name)
    with TemporaryDirectory() as folder:
        other = Path(folder) / "rewritten.tif"
        other.write_bytes(plan.data)
        return plan.restore(sitk.GetArrayFromImage(_read(other, name)), name)


def _read(path: Path, name: str, reader: str = "TIFFImageIO") -> "sitk.Image":
    image, said = _attempt(path, reader)
    if image is None:
        why = reason(said).replace(str(path), path.name)
        message = f"{name}: the file is damaged, truncated or no image ({why}). Copy it again."
        raise ImageError(message)
    return image


def _attempt(path: Path, reader: str = "") -> tuple["sitk.Image | None", list[str]]:
    """What SimpleITK reads, if it can, and all that it and its libraries say about it."""
    import SimpleITK as sitk

    image, error = None, ""
    with muted() as said:
        try:
            image = sitk.ReadImage(str(path), imageIO=reader)
        except RuntimeError as fault:
            error = str(fault)
    # Libraries that say anything say it better than the exception.
    return image, error.splitlines() + said


def reason(said: list[str]) -> str:
    """The most telling line of what SimpleITK says, without its own clutter."""
    lines = [_CLUTTER.sub("", line).strip() for line in said if not _NO_REASON.match(line)]
    return lines[-1].rstrip(".") if lines else "no reason given"


def _with_pillow(path: Path, name: str) -> NDArray[Any]:
    from PIL import Image as Pillow
    from PIL import UnidentifiedImageError

    with warnings.catch_warnings():
        # It warns of large pictures and of odd remarks in them; neither is a fault.
        warnings.simplefilter("ignore")
        try:
            with Pillow.open(path) as opened:
                depth = str(opened.tile)
                opened.load()
                return _planes(opened, depth, name)
        except UnidentifiedImageError:
            message = (
                f"{name}: this is no image, whatever its suffix says. Open it in a viewer, or name another."
            )
        except (OSError, SyntaxError, ValueError, Pillow.DecompressionBombError) as error:
            message = f"{name}: the file is damaged or truncated ({error}). Copy it again."
    raise ImageError(message)


def _planes(opened: "Pillow.Image", depth: str, name: str) -> NDArray[Any]:
    if opened.mode in ("LA", "RGB", "RGBA") and ";16" in depth:
        message = f"{name}: grey with alpha of 16 bits cannot be read without loss. Save it without alpha."
        raise ImageError(message)
    if opened.mode in ("1", "LA", "La"):
        return np.array(opened.convert("L"))
    if opened.mode in ("L", "I", "F", "RGB", "RGBA") or opened.mode.startswith("I;16"):
        pixels = np.array(opened)
        return pixels.astype(pixels.dtype.newbyteorder("="))
    return np.array(opened.convert("RGB"))
