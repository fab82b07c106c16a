"""Similarity: y = s R (x - c) + c + t."""

from typing import final

import numpy as np

from regframe.geometry import Frame
from regframe.transforms.linear import Linear, turn
from regframe.transforms.rotations import nearest_rotation, turned, versor_matrix, versor_of, versor_slopes
from regframe.types import Matrix, Params

QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


@final
class Similarity(Linear):
    """Scale, rotation and shift: scale, angle (radians), tx, ty; in 3-D vx, vy, vz, tx, ty, tz, scale.

    In 2-D `itk::Similarity2DTransform`; one of the two models of Mascarich and Alexis, "Visual-Thermal
    Camera Dataset Release and Multi-Modal Alignment without Calibration Information". In 3-D
    `itk::Similarity3DTransform`, whose rotation is a versor: see `versor-rigid`.
    """

    def identity(self, frame: Frame) -> Params:
        """Scale 1, nothing else."""
        if frame.dim == 2:
            return np.array([1.0, 0.0, 0.0, 0.0])
        return np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])

    def names(self, frame: Frame) -> tuple[str, ...]:
        """Scale, angle in radians, then the shift; in 3-D the versor, the shift, then the scale."""
        if frame.dim == 2:
            return ("scale", "angle_rad", "tx", "ty")
        return ("vx", "vy", "vz", "tx", "ty", "tz", "scale")

    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Scaled rotation and shift."""
        if dim == 2:
            return params[0] * turn(params[1]), params[2:]
        return versor_matrix(params[:3]) * params[6], params[3:6]

    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Derivatives by scale, angle and shift; in 3-D by versor, shift and scale."""
        matrices = np.zeros((len(params), dim, dim))
        if dim == 2:
            matrices[0] = turn(params[1])
            matrices[1] = params[0] * (QUARTER_TURN @ turn(params[1]))
            return matrices, np.eye(4, 2, -2)
        matrices[:3] = params[6] * versor_slopes(params[:3])
        matrices[6] = versor_matrix(params[:3])
        return matrices, np.eye(7, 3, -3)

    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """Nearest scaled rotation in the least-squares sense."""
        if len(matrix) == 2:
            along = (matrix[0, 0] + matrix[1, 1]) / 2
            across = (matrix[1, 0] - matrix[0, 1]) / 2
            return np.array([np.hypot(along, across), np.arctan2(across, along), *translation])
        rotation, scale = nearest_rotation(matrix)
        return np.array([*versor_of(rotation), *translation, scale])

    def advance(self, params: Params, step: Params, frame: Frame) -> Params:
        """In 3-D the rotation is composed, all else added; see `turned`."""
        return params + step if len(params) == 4 else turned(params, step)
