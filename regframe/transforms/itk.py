"""Which class of ITK each family is, by dimension."""

from regframe.transforms.affine import Affine
from regframe.transforms.base import Transform
from regframe.transforms.rigid import Rigid
from regframe.transforms.scale import Scale
from regframe.transforms.scale_skew_versor import ScaleSkewVersor
from regframe.transforms.scale_versor import ScaleVersor
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.versor import Versor
from regframe.transforms.versor_rigid import VersorRigid
from regframe.types import Params

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
"""Family and dimension, and the class of ITK with the same parameters in the same order."""

EITHER = ("AffineTransform", "ScaleTransform", "TranslationTransform")
"""Classes that SimpleITK builds with a dimension; the others have one."""


def fixed_parameters(transform: Transform, centre: Params) -> list[float]:
    """What ITK keeps beside the parameters: the centre, and the order of angles in space.

    Examples
    --------
    >>> import numpy as np
    >>> fixed_parameters(Rigid(order="zyx"), np.zeros(3))
    [0.0, 0.0, 0.0, 1.0]
    """
    if isinstance(transform, Translation):
        return []
    order = [float(transform.order == "zyx")] if isinstance(transform, Rigid) and len(centre) == 3 else []
    return [*map(float, centre), *order]
