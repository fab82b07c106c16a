"""What several commands take: image files, masks, transforms, and hints where one is missing."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from regframe.errors import ImageError

if TYPE_CHECKING:
    from regframe.engine.setting import Placement
    from regframe.geometry import Grid
    from regframe.image import Image
    from regframe.transforms.warp import Chain, Warp

Start = Annotated[
    Path | None,
    typer.Option(help="Begin at this transform.json or ITK transform file, not at the preset's start."),
]
MovingInitial = Annotated[
    Path | None,
    typer.Option(help="Transform file of a map that stays, applied after the searched one."),
]
FixedInitial = Annotated[
    Path | None,
    typer.Option(
        help="Transform file of an affine map that stays, from the sampled grid to the fixed image."
    ),
]
Domain = Annotated[
    Path | None, typer.Option(help="Compare at the points of this image's grid, not the fixed image's.")
]

ROLES = (
    "fixed image",
    "moving image",
    "fixed mask",
    "moving mask",
    "start transform",
    "moving-initial transform",
    "fixed-initial transform",
    "domain image",
)


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


def everything(
    fixed: Path, moving: Path, masks: tuple[Path | None, Path | None], known: "Files"
) -> tuple["Image", "Image", "Placement"]:
    """Both images with their masks, and where they are known to lie.

    Raises
    ------
    ImageError, GeometryError
        A file is not there, told before any is read; or it cannot be read.
    """
    for path, role in zip((fixed, moving, *masks, *known), ROLES, strict=True):
        if path is not None:
            existing(path, role)
    below = image(fixed, "fixed", masks[0])
    return below, image(moving, "moving", masks[1]), placement(known, below.grid)


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


def placement(files: "Files", grid: "Grid") -> "Placement":
    """What the options tell of the images' places; `grid` is the fixed image's."""
    from regframe.engine.setting import Placement

    domain = None if files.domain is None else image(files.domain, "domain").grid
    around = grid if domain is None else domain
    start, beyond, below = (None if path is None else transform(path, around) for path in files[:3])
    return Placement(start, beyond, below, domain)


class Files(NamedTuple):
    """Files that place the images: three transforms, and the image whose grid is sampled."""

    start: Path | None = None
    moving_initial: Path | None = None
    fixed_initial: Path | None = None
    domain: Path | None = None


def _hint(path: Path) -> str:
    from regframe.faults import nearest

    folder = path.parent
    while not folder.is_dir():
        path, folder = folder, folder.parent
    near = nearest(path.name, (one.name for one in folder.iterdir()))
    return near or f" Check the spelling; {str(folder)!r} holds nothing of a similar name."
