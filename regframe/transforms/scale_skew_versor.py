"""Rotation, scales, skews and shift in space: y = (R(v) + S - I + K) (x - c) + c + t."""

from typing import ClassVar, final

import numpy as np

from regframe.geometry import Frame
from regframe.transforms.linear import Linear
from regframe.transforms.rotations import nearest_rotation, turned, versor_matrix, versor_of, versor_slopes
from regframe.types import Matrix, Params

ROWS, COLUMNS = (0, 0, 1, 1, 2, 2), (1, 2, 0, 2, 0, 1)


@final
class ScaleSkewVersor(Linear):
    """Versor, shift, three scales and six skews in 3-D: an affine map written with 15 numbers.

    `itk::ScaleSkewVersor3DTransform`: scales, less 1, and skews are added to the rotation matrix, skews off
    the diagonal, row by row. Three numbers are too many, so parameters are not unique; `affine` has all of
    these maps with 12. Versor and steps are as in `versor-rigid`.
    """

    dimensions: ClassVar[tuple[int, ...]] = (3,)

    def identity(self, frame: Frame) -> Params:
        """No rotation, no shift, scales 1, no skew."""
        return np.array([*np.zeros(6), *np.ones(3), *np.zeros(6)])

    def names(self, frame: Frame) -> tuple[str, ...]:
        """The versor's components, the shift, the scales, the skews by row and column."""
        skews = (f"skew_{'xyz'[r]}{'xyz'[c]}" for r, c in zip(ROWS, COLUMNS, strict=True))
        return ("vx", "vy", "vz", "tx", "ty", "tz", "scale_x", "scale_y", "scale_z", *skews)

    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Rotation plus scales less 1 plus skews, and shift."""
        matrix = versor_matrix(params[:3]) + np.diag(params[6:9] - 1.0)
        matrix[ROWS, COLUMNS] += params[9:]
        return matrix, params[3:6]

    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Derivatives by versor, shift, scales and skews."""
        matrices = np.zeros((15, 3, 3))
        matrices[:3] = versor_slopes(params[:3])
        matrices[range(6, 15), (0, 1, 2, *ROWS), (0, 1, 2, *COLUMNS)] = 1.0
        return matrices, np.eye(15, 3, -3)

    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """The map itself: the nearest rotation, scales and skews for the rest."""
        rotation = nearest_rotation(matrix)[0]
        rest = matrix - rotation
        return np.concatenate([versor_of(rotation), translation, 1.0 + np.diag(rest), rest[ROWS, COLUMNS]])

    def advance(self, params: Params, step: Params, frame: Frame) -> Params:
        """Rotations compose, all else adds; see `turned`."""
        return turned(params, step)
