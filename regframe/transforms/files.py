"""Warps to and from ITK transform files."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from regframe.errors import GeometryError, OutputError
from regframe.geometry import Frame, Grid
from regframe.io import atomic, refuse_existing
from regframe.io.decoding import reason
from regframe.io.muted import muted
from regframe.io.writing import is_there
from regframe.transforms import json_files
from regframe.transforms.affine import Affine
from regframe.transforms.base import Transform
from regframe.transforms.bspline import BSpline
from regframe.transforms.displacement_field import DisplacementField
from regframe.transforms.fields import displacement_field
from regframe.transforms.itk import BENDING, KINDS, made
from regframe.transforms.rigid import Rigid
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Chain, Warp, chain

if TYPE_CHECKING:
    import SimpleITK as sitk

TEXT = (".tfm", ".txt")
SUFFIXES = (*TEXT, ".h5", ".hdf5")
READABLE = (*SUFFIXES, ".mat", ".json")

_OURS: dict[str, Callable[[], Transform]] = {
    "TranslationTransform": Translation,
    "Euler2DTransform": Rigid,
    "Similarity2DTransform": Similarity,
    "AffineTransform": Affine,
}
"""Classes of ITK whose parameters are those of ours."""

_MATRIX_AND_CENTRE = (
    "Euler3DTransform",
    "ScaleSkewVersor3DTransform",
    "ScaleTransform",
    "ScaleVersor3DTransform",
    "Similarity3DTransform",
    "VersorRigid3DTransform",
    "VersorTransform",
)
"""Classes of ITK that are read as affine maps."""


_BENDING = ("BSplineTransform", "DisplacementFieldTransform")


def write(warp: Warp | Chain, path: str | Path, *, force: bool = False) -> None:
    """Write a warp as an ITK transform file, which SimpleITK, ITK and Slicer read.

    A family of `itk.KINDS` keeps its parameters and centre, a B-spline or a displacement field its lattice;
    any other affine one becomes an `AffineTransform`, a chain a `CompositeTransform` in the same order. A
    map that ITK lacks, such as a homography, becomes a `DisplacementFieldTransform` over the fixed image,
    exact to a hundredth of a pixel. Large fields are smaller and quicker as ``.h5``.

    Parameters
    ----------
    warp : Warp or Chain
    path : path
        ``.tfm`` or ``.txt`` for text, ``.h5`` for HDF5.
    force : bool
        Overwrite what is there.

    Raises
    ------
    OutputError
        Another suffix, the file exists and `force` is off, or it cannot be written.

    Examples
    --------
    >>> frame = Frame.about_centre(Grid.of_shape((480, 640)))
    >>> write(Warp(Rigid(), np.array([0.5, 3.0, 4.0]), frame), "warp.tfm")
    >>> read("warp.tfm", frame.grid).params
    array([0.5, 3. , 4. ])
    """
    import SimpleITK as sitk

    target = Path(path)
    if not target.name.endswith(SUFFIXES):
        message = (
            f"cannot write {str(target)!r}: transforms are not written as {target.suffix!r}. "
            f"Use {', '.join(SUFFIXES)}."
        )
        raise OutputError(message)
    whole = _to_itk(warp)
    refuse_existing(target, force)
    error = ""
    with atomic(target) as temporary:
        with muted() as said:
            try:
                sitk.WriteTransform(whole, str(temporary))
            except RuntimeError as fault:
                error = str(fault)
        if error:
            message = (
                f"cannot write {str(target)!r}: {reason(error.splitlines() + said)}. Name another place."
            )
            raise OutputError(message)


def read(path: str | Path, grid: Grid) -> Warp | Chain:
    """Read an ITK transform file, or the ``transform.json`` of a result.

    Parameters
    ----------
    path : path
        ``.tfm``, ``.txt``, ``.h5``, ``.mat`` or ``.json``.
    grid : Grid
        The fixed grid; the centre is the file's, or the grid's for a translation.

    Returns
    -------
    Warp or Chain
        Affine for those of ITK's transforms that are a matrix and a centre, and that we lack.

    Raises
    ------
    GeometryError
        The file is missing or damaged, of other dimensions than the grid, or holds a transform that is
        neither affine nor a B-spline nor a displacement field.
    """
    place = Path(path)
    _check_file(place)
    if place.name.endswith(".json"):
        return json_files.read(place, grid)
    whole = _read_itk(place)
    if whole.GetDimension() != grid.dim:
        message = (
            f"{path}: the transform is {whole.GetDimension()}-D and the image {grid.dim}-D. "
            "Both must have the same number of axes."
        )
        raise GeometryError(message)
    warps = [_from_itk(part, grid, str(path)) for part in _parts(whole)]
    return chain(warps or [Warp(Translation(), np.zeros(grid.dim), Frame.about_centre(grid))])


def _to_itk(warp: Warp | Chain) -> "sitk.Transform":
    import SimpleITK as sitk

    if any(not exact(part) for part in (warp.warps if isinstance(warp, Chain) else (warp,))):
        # A field covers the fixed image, so a chain with such a member becomes one as a whole.
        return _field(warp)
    if isinstance(warp, Chain):
        return sitk.CompositeTransform([_to_itk(part) for part in warp.warps])
    dim, affine = warp.frame.dim, warp.as_affine()
    if (type(warp.transform), dim) not in KINDS and affine is not None:
        warp = Warp.of_affine(affine, warp.frame)
    theirs = made(warp.transform, warp.frame)
    theirs.SetParameters(warp.transform.advance(warp.params, np.zeros_like(warp.params), warp.frame).tolist())
    return theirs


def exact(warp: Warp) -> bool:
    """Whether ITK has a transform of the same parameters, or an affine one for it; else it gets a field."""
    kind = type(warp.transform)
    return kind in BENDING or (kind, warp.frame.dim) in KINDS or warp.as_affine() is not None


def _field(warp: Warp | Chain) -> "sitk.Transform":
    import SimpleITK as sitk

    grid, moved = displacement_field(warp)
    field = sitk.GetImageFromArray(moved.reshape(*grid.shape, grid.dim), isVector=True)
    field.SetSpacing(grid.spacing)
    field.SetOrigin(grid.origin)
    field.SetDirection([value for row in grid.direction for value in row])
    return sitk.DisplacementFieldTransform(field)


def _read_itk(path: Path) -> "sitk.Transform":
    import SimpleITK as sitk

    error = ""
    whole: sitk.Transform | None = None
    with muted() as said:
        try:
            whole = sitk.ReadTransform(str(path))
        except RuntimeError as fault:
            error = str(fault)
    if whole is None:
        why = reason(error.splitlines() + said)
        message = f"{path}: the file is damaged or holds no ITK transform ({why}). Write it anew."
        raise GeometryError(message)
    return whole


def _parts(whole: "sitk.Transform") -> list["sitk.Transform"]:
    """Members of a composite transform; a single one as it is."""
    import SimpleITK as sitk

    if whole.GetName() != "CompositeTransform":
        return [whole]
    composite = sitk.CompositeTransform(whole)
    return [_unwrapped(composite.GetNthTransform(i)) for i in range(composite.GetNumberOfTransforms())]


def _unwrapped(member: "sitk.Transform") -> "sitk.Transform":
    """The transform of a class that SimpleITK lacks and wraps: ITK's plain matrix and offset, as of ANTs."""
    import SimpleITK as sitk

    dim, params, centre = member.GetDimension(), member.GetParameters(), member.GetFixedParameters()
    plain = member.IsLinear() and len(params) == dim * dim + dim and len(centre) == dim
    if member.GetName() != "CompositeTransform" or not plain:
        return member
    affine = sitk.AffineTransform(dim)
    affine.SetFixedParameters(centre)
    affine.SetParameters(params)
    return affine


def _from_itk(theirs: "sitk.Transform", grid: Grid, path: str) -> Warp:
    import SimpleITK as sitk

    kind = theirs.GetName()
    if theirs.GetTransformEnum() == sitk.sitkIdentity:
        return Warp(Translation(), np.zeros(grid.dim), Frame.about_centre(grid))
    if kind == "TranslationTransform":
        return Warp(Translation(), np.array(theirs.GetParameters()), Frame.about_centre(grid))
    if kind in _BENDING:
        return _bending(theirs, grid)
    if kind not in _OURS and kind not in _MATRIX_AND_CENTRE:
        message = (
            f"{path}: {kind} is unknown. Convert it to one of "
            f"{', '.join((*_OURS, *_MATRIX_AND_CENTRE, *_BENDING))}."
        )
        raise GeometryError(message)
    typed = theirs.Downcast()
    centre = np.array(typed.GetCenter())
    if kind in _OURS:
        return Warp(_OURS[kind](), np.array(theirs.GetParameters()), Frame(grid, centre))
    # The centre moves by the translation alone.
    translation = np.array(typed.TransformPoint(centre.tolist())) - centre
    return Warp(Affine(), np.concatenate([typed.GetMatrix(), translation]), Frame(grid, centre))


def _bending(theirs: "sitk.Transform", grid: Grid) -> Warp:
    """A B-spline or a displacement field on the lattice that the file tells."""
    dim, told = theirs.GetDimension(), theirs.GetFixedParameters()
    size, origin, spacing = (told[i * dim : (i + 1) * dim] for i in range(3))
    rows = tuple(tuple(told[(3 + i) * dim : (4 + i) * dim]) for i in range(dim))
    lattice = Grid(tuple(int(n) for n in reversed(size)), tuple(spacing), tuple(origin), rows)
    family: Transform = DisplacementField()
    if theirs.GetName() == "BSplineTransform":
        order = theirs.Downcast().GetOrder()
        mesh = tuple(int(n) - order for n in size)
        family = BSpline(mesh=mesh[:1] if len(set(mesh)) == 1 else mesh, order=order)
    return Warp(family, np.array(theirs.GetParameters()), Frame(grid, grid.centre, lattice=lattice))


def _check_file(path: Path) -> None:
    if not (is_there(path) and path.is_file()):
        message = f"{path}: there is no such transform file. Check the path."
        raise GeometryError(message)
    if not path.name.endswith(READABLE):
        message = f"{path}: no transform format has the suffix {path.suffix!r}. Known: {', '.join(READABLE)}."
        raise GeometryError(message)
    if path.name.endswith(TEXT):
        _check_text(path)


def _check_text(path: Path) -> None:
    """Refuse a text file that breaks off: ITK gives the identity for parameters that are missing."""
    text = path.read_text(encoding="utf-8", errors="replace")
    heads = [line.partition(":")[0].strip() for line in text.splitlines()]
    kinds = [line for line in text.splitlines() if line.startswith("Transform:")]
    wanted = sum("CompositeTransform" not in kind for kind in kinds)
    met = min(heads.count("Parameters"), heads.count("FixedParameters"))
    if not kinds:
        message = f"{path}: it holds no transform. Name an ITK transform file, or a result's transform.json."
        raise GeometryError(message)
    if met < wanted or not text.endswith("\n"):
        message = (
            f"{path}: the transform file is damaged or truncated: of {wanted} transforms, {met} have "
            "parameters. Write it anew."
        )
        raise GeometryError(message)
