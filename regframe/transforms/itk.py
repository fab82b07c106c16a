"""Which class of ITK each family is, by dimension."""

from typing import TYPE_CHECKING

from regframe.geometry import Frame
from regframe.transforms.affine import Affine
from regframe.transforms.base import Transform
from regframe.transforms.bspline import BSpline
from regframe.transforms.displacement_field import DisplacementField
from regframe.transforms.lattice import lattice
from regframe.transforms.rigid import Rigid
from regframe.transforms.scale import Scale
from regframe.transforms.scale_skew_versor import ScaleSkewVersor
from regframe.transforms.scale_versor import ScaleVersor
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.versor import Versor
from regframe.transforms.versor_rigid import VersorRigid

if TYPE_CHECKING:
    import SimpleITK as sitk

KINDS: dict[tuple[type[Transform], int], str] = {
    (Affine, 2): "AffineTransform",
    (Affine, 3): "AffineTransform",
    (Rigid, 2): "Euler2DTransform",
    (Rigid, 3): "Euler3DTransform",
    (Scale, 2): "ScaleTransform",
    (Scale, 3): "ScaleTransform",
    (ScaleSkewVersor, 3): "ScaleSkewVersor3DTransform",
    (ScaleVersor, 3): "ScaleVersor3DTransform",
    (Similarity, 2): "Similarity2DTransform",
    (Similarity, 3): "Similarity3DTransform",
    (Translation, 2): "TranslationTransform",
    (Translation, 3): "TranslationTransform",
    (Versor, 3): "VersorTransform",
    (VersorRigid, 3): "VersorRigid3DTransform",
}
"""Affine families by dimension, and the class of ITK with the same parameters in the same order."""

BENDING: tuple[type[Transform], ...] = (BSpline, DisplacementField)
"""Families that bend and are ITK's, too, in all dimensions."""

EITHER = ("AffineTransform", "ScaleTransform", "TranslationTransform")
"""Classes that SimpleITK builds with a dimension; the others have one."""


def made(transform: Transform, frame: Frame) -> "sitk.Transform":
    """ITK's transform of a family, about the frame's centre or on its lattice; parameters come later.

    Parameters
    ----------
    transform : Transform
        One of `KINDS` or `BENDING`.
    """
    import SimpleITK as sitk

    theirs: sitk.Transform
    if isinstance(transform, BSpline):
        theirs = sitk.BSplineTransform(frame.dim, transform.order)
    elif isinstance(transform, DisplacementField):
        theirs = sitk.DisplacementFieldTransform(frame.dim)
    else:
        kind = KINDS[type(transform), frame.dim]
        theirs = getattr(sitk, kind)(*((frame.dim,) if kind in EITHER else ()))
    theirs.SetFixedParameters(fixed_parameters(transform, frame))
    return theirs


def fixed_parameters(transform: Transform, frame: Frame) -> list[float]:
    """What ITK keeps beside the parameters: the centre, the order of angles in space, or the lattice.

    Examples
    --------
    >>> from regframe.geometry import Grid
    >>> fixed_parameters(Rigid(order="zyx"), Frame.about_centre(Grid.of_shape((5, 5, 5))))
    [2.0, 2.0, 2.0, 1.0]
    """
    if isinstance(transform, BSpline | DisplacementField):
        grid = frame.lattice or frame.grid
        if isinstance(transform, BSpline) and frame.lattice is None:
            grid = lattice(frame.grid, transform.mesh, transform.order)
        rows = (value for row in grid.direction for value in row)
        return [*map(float, reversed(grid.shape)), *grid.origin, *grid.spacing, *rows]
    if isinstance(transform, Translation):
        return []
    order = [float(transform.order == "zyx")] if isinstance(transform, Rigid) and frame.dim == 3 else []
    return [*map(float, frame.centre), *order]
