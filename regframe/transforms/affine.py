"""Affine map: y = M (x - c) + c + t."""

from collections.abc import Mapping
from typing import final

import numpy as np

from regframe.errors import PresetError
from regframe.geometry import Frame
from regframe.transforms.linear import Linear, turn
from regframe.types import Matrix, Params

FACTORS = ("tx", "ty", "rotation_rad", "scale_x", "scale_y", "shear_x", "shear_y")


@final
class Affine(Linear):
    """Any matrix and shift: parameters are the matrix row by row, then tx, ty (, tz).

    `itk::AffineTransform`. `factors` and `from_factors` speak of the plane's affine maps as Mascarich and
    Alexis do: translation, rotation, scale and shear, see "Visual-Thermal Camera Dataset Release and
    Multi-Modal Alignment without Calibration Information".
    """

    def identity(self, frame: Frame) -> Params:
        """Identity matrix, no shift."""
        return np.concatenate([np.eye(frame.dim).ravel(), np.zeros(frame.dim)])

    def names(self, frame: Frame) -> tuple[str, ...]:
        """Matrix entries by row and column, then the shift."""
        axes = "xyz"[: frame.dim]
        return (*(f"m{r}{c}" for r in axes for c in axes), *(f"t{a}" for a in axes))

    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Matrix and shift."""
        return params[: dim * dim].reshape(dim, dim), params[dim * dim :]

    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Unit matrices, then unit shifts."""
        square = dim * dim
        matrices = np.concatenate([np.eye(square), np.zeros((dim, square))]).reshape(-1, dim, dim)
        return matrices, np.eye(square + dim, dim, -square)

    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """The map itself."""
        return np.concatenate([matrix.ravel(), translation])


def from_factors(factors: Mapping[str, float]) -> Params:
    """Affine parameters in 2-D from translation, rotation, scales and shears.

    The matrix is ``R(rotation) @ [[1, shear_x], [shear_y, 1]] @ diag(scale_x, scale_y)``. Factors that
    are left out take their neutral value.

    Parameters
    ----------
    factors : mapping
        Any of tx, ty, rotation_rad, scale_x, scale_y, shear_x, shear_y.

    Returns
    -------
    (6,) float64
        Parameters of `Affine` about its frame's centre.

    Raises
    ------
    PresetError
        An unknown factor.

    Examples
    --------
    >>> from_factors({"scale_x": 2.0, "tx": 5.0})
    array([2., 0., 0., 1., 5., 0.])
    """
    unknown = sorted(set(factors) - set(FACTORS))
    if unknown:
        message = f"unknown affine factors {unknown}. Known: {', '.join(FACTORS)}."
        raise PresetError(message)
    neutral = {"scale_x": 1.0, "scale_y": 1.0}
    tx, ty, rotation, scale_x, scale_y, shear_x, shear_y = (
        float(factors.get(name, neutral.get(name, 0.0))) for name in FACTORS
    )
    shear = np.array([[1.0, shear_x], [shear_y, 1.0]])
    matrix = turn(rotation) @ shear @ np.diag([scale_x, scale_y])
    return np.concatenate([matrix.ravel(), [tx, ty]])


def factors(matrix: Matrix, translation: Params) -> dict[str, float]:
    """Translation, rotation, scales and shear of an affine map in the plane.

    Rotation and both shears are one number too many for a matrix, so the shear is given along x and
    ``shear_y`` is 0: the matrix is ``R(rotation) @ [[1, shear_x], [0, 1]] @ diag(scale_x, scale_y)``.

    Parameters
    ----------
    matrix : (2, 2) float64
    translation : (2,) float64

    Returns
    -------
    dict
        The seven names of `FACTORS`; `from_factors` turns them back into the same map.
    """
    rotation = float(np.arctan2(matrix[1, 0], matrix[0, 0]))
    upright = turn(-rotation) @ matrix
    scale_x, scale_y = float(upright[0, 0]), float(upright[1, 1])
    shear_x = float(upright[0, 1] / scale_y) if scale_y else 0.0
    found = (*map(float, translation), rotation, scale_x, scale_y, shear_x, 0.0)
    return dict(zip(FACTORS, found, strict=True))
