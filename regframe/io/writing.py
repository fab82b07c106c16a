"""Files written whole or not at all."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from secrets import token_hex
from typing import Any

import numpy as np
from numpy.typing import NDArray

from regframe.errors import GeometryError, OutputError
from regframe.geometry import Grid
from regframe.io import tiff
from regframe.io.convert import array_to_sitk
from regframe.io.decoding import reason
from regframe.io.muted import muted

_SMALL = ("uint8", "uint16", "int8", "int16", "uint32", "int32", "float32")
_WIDE = ("uint64", "int64", "float64")
_TIFF = (*_SMALL, *_WIDE)
_GEOMETRIC = (".nrrd", ".mha", ".nii", ".nii.gz")

TYPES = {
    ".png": ("uint8", "uint16"),
    ".jpg": ("uint8",),
    ".jpeg": ("uint8",),
    ".bmp": ("uint8",),
    ".tif": _TIFF,
    ".tiff": _TIFF,
    **dict.fromkeys(_GEOMETRIC, (*_SMALL, *_WIDE)),
}
"""Number types that each format holds."""

_TWO_FILES = {".mhd": ".mha", ".nhdr": ".nrrd", ".hdr": ".nii", ".img": ".nii"}


def write(array: NDArray[Any], grid: Grid, path: str | Path, *, force: bool = False) -> None:
    """Write pixels to the format that the file's suffix names.

    NRRD, MHA and NIfTI keep where the grid lies; PNG, JPEG, BMP and TIFF keep the pixels alone. True and
    False become 255 and 0.

    Parameters
    ----------
    array : (ny, nx) or (nz, ny, nx) array, in 2-D with a last axis of 3 or 4 for colour
    grid : Grid
    path : path
    force : bool
        Overwrite what is there.

    Raises
    ------
    OutputError
        The format cannot hold such pixels, the file exists and `force` is off, or it cannot be written.
    GeometryError
        The array does not fit the grid.

    Examples
    --------
    >>> pixels = np.arange(12, dtype=np.uint16).reshape(3, 4)
    >>> write(pixels, Grid.of_shape(pixels.shape), "small.png")
    """
    target = Path(path)
    pixels = np.asarray(array)
    pixels = pixels.astype(np.uint8) * np.uint8(255) if pixels.dtype == np.bool_ else pixels
    _check(pixels, grid, target)
    refuse_existing(target, force)
    with atomic(target) as temporary:
        if pixels.dtype.name in _WIDE and _suffix(target) in (".tif", ".tiff"):
            temporary.write_bytes(tiff.encode(pixels))
        else:
            _with_sitk(pixels, grid, temporary, target)


@contextmanager
def atomic(path: str | Path) -> Iterator[Path]:
    """A temporary path in the same folder, renamed to `path` on success and removed on any failure.

    Its name ends as that of `path` does, in small letters: writers choose their format by it.

    Raises
    ------
    OutputError
        The folder is missing, or the file cannot be written.

    Examples
    --------
    >>> with atomic("note.txt") as temporary:
    ...     _ = temporary.write_text("whole")
    >>> Path("note.txt").read_text()
    'whole'
    """
    target = Path(path)
    if is_there(target) and target.is_dir():
        message = f"cannot write {str(target)!r}: it is a folder. Name a file in it."
        raise OutputError(message)
    if not target.parent.is_dir():
        message = f"cannot write {str(target)!r}: its folder does not exist. Make it first, or name another."
        raise OutputError(message)
    temporary = target.with_name(f".{token_hex(4)}.{target.name.lower()}")
    try:
        # Asking first gives the system's reason; writers have many ways to hide it.
        temporary.touch()
        yield temporary
        temporary.replace(target)
    except OSError as error:
        message = (
            f"cannot write {str(target)!r}: {error.strerror or error}. Name another place, or make room."
        )
        raise OutputError(message) from error
    finally:
        # Nothing is left to remove after the renaming; a Ctrl-C passes here as well.
        with suppress(OSError):
            temporary.unlink()


def refuse_existing(path: str | Path, force: bool) -> None:
    """Stop before a file is overwritten that nobody said may be.

    Raises
    ------
    OutputError
        The file exists and `force` is off.

    Examples
    --------
    >>> refuse_existing("not-there.png", force=False)
    """
    if not force and is_there(Path(path)):
        message = (
            f"{str(path)!r} exists already. Name another file, or add --force (force=True) to replace it."
        )
        raise OutputError(message)


def is_there(path: Path) -> bool:
    """Whether a path exists; a name that the file system does not take does not."""
    try:
        return path.exists()
    except OSError:
        return False


def _suffix(path: Path) -> str:
    """The known ending of a file's name, or its last one."""
    name = path.name.lower()
    return next((known for known in TYPES if name.endswith(known)), path.suffix.lower())


def _check(pixels: NDArray[Any], grid: Grid, path: Path) -> None:
    suffix = _suffix(path)
    if suffix not in TYPES:
        known = ", ".join(TYPES)
        instead = f"{suffix} takes two files; write {_TWO_FILES[suffix]}" if suffix in _TWO_FILES else known
        message = (
            f"cannot write {str(path)!r}: images are not written as {suffix or 'no suffix'!r}. Use {instead}."
        )
        raise OutputError(message)
    coloured = pixels.ndim == grid.dim + 1 and grid.dim == 2 and pixels.shape[-1] in (3, 4)
    if pixels.shape[: grid.dim] != grid.shape or not (coloured or pixels.ndim == grid.dim):
        message = (
            f"cannot write {str(path)!r}: an array of shape {pixels.shape} does not fit a grid of "
            f"{grid.shape}. Colour is a last axis of 3 or 4, in 2-D alone."
        )
        raise GeometryError(message)
    fault = _fault(pixels, grid, suffix, coloured)
    if fault:
        message = f"cannot write {str(path)!r}: {suffix} cannot hold {fault}"
        raise OutputError(message)


def _fault(pixels: NDArray[Any], grid: Grid, suffix: str, coloured: bool) -> str:
    """Why a format cannot hold these pixels and what to do; empty if it can."""
    if pixels.dtype.name not in TYPES[suffix]:
        others = ", ".join(known for known, types in TYPES.items() if pixels.dtype.name in types)
        instead = f"write {others}" if others else "convert to float32"
        return f"pixels of type {pixels.dtype}, only {', '.join(TYPES[suffix])}. Convert them, or {instead}."
    if suffix in _GEOMETRIC:
        return ""
    wide = suffix in (".tif", ".tiff") and pixels.dtype.name in _WIDE
    if grid.dim == 3 and (wide or not suffix.startswith(".tif")):
        return f"a volume of {pixels.dtype}, shape {pixels.shape}. Write {', '.join(_GEOMETRIC)}."
    if coloured and (wide or (pixels.shape[-1] == 4 and suffix in (".jpg", ".jpeg"))):
        return f"{pixels.shape[-1]} channels of {pixels.dtype}. Drop alpha, convert them, or write .nrrd."
    return ""


def _with_sitk(pixels: NDArray[Any], grid: Grid, temporary: Path, target: Path) -> None:
    import SimpleITK as sitk

    native = np.ascontiguousarray(pixels, pixels.dtype.newbyteorder("="))
    # Formats without geometry would store its spacing as a resolution in dots per inch.
    place = grid if _suffix(target) in _GEOMETRIC else Grid.of_shape(grid.shape)
    error = ""
    with muted() as said:
        try:
            sitk.WriteImage(array_to_sitk(native, place), str(temporary))
        except RuntimeError as fault:
            error = str(fault)
    if error:
        message = f"cannot write {str(target)!r}: {reason(error.splitlines() + said)}. Name another place."
        raise OutputError(message)
