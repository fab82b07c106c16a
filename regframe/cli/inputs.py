"""What several commands take: image files, masks, transforms, and hints where one is missing."""

from pathlib import Path
from typing import TYPE_CHECKING

from regframe.errors import ImageError

if TYPE_CHECKING:
    from regframe.geometry import Grid
    from regframe.image import Image
    from regframe.transforms.warp import Chain, Warp


def existing(path: Path, role: str) -> Path:
    """The path of a file that is there.

    Parameters
    ----------
    path : Path
    role : str
        What the message calls it, such as ``fixed image``.

    Raises
    ------
    ImageError
        There is no such file; the nearest name in its folder is told.
    """
    if path.is_file():
        return path
    if path.is_dir():
        message = f"the {role} {str(path)!r} is a folder. Name a file in it."
        raise ImageError(message)
    message = f"the {role} {str(path)!r} does not exist.{_hint(path)}"
    raise ImageError(message)


def image(path: Path, role: str, mask: Path | None = None) -> "Image":
    """Read an image file, and its mask where there is one."""
    from regframe.io import read, read_mask

    found = read(existing(path, f"{role} image"))
    if mask is None:
        return found
    return found.with_mask(read_mask(existing(mask, f"{role} mask"), found.grid))


def transform(path: Path, grid: "Grid") -> "Warp | Chain":
    """Read an ITK transform file that starts from a grid."""
    from regframe.transforms import files

    return files.read(existing(path, "transform"), grid)


def _hint(path: Path) -> str:
    from regframe.faults import nearest

    folder = path.parent
    while not folder.is_dir():
        path, folder = folder, folder.parent
    near = nearest(path.name, (one.name for one in folder.iterdir()))
    return near or f" Check the spelling; {str(folder)!r} holds nothing of a similar name."
