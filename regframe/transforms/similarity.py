"""Similarity in the plane: y = s R(angle) (x - c) + c + t."""

from typing import ClassVar, final

import numpy as np

from regframe.geometry import Frame
from regframe.transforms.linear import Linear, turn
from regframe.types import Matrix, Params

QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


@final
class Similarity(Linear):
    """Scale, rotation and shift in 2-D: parameters scale, angle (radians), tx, ty.

    `itk::Similarity2DTransform`; one of the two models of Mascarich and Alexis, "Visual-Thermal Camera
    Dataset Release and Multi-Modal Alignment without Calibration Information".
    """

    dimensions: ClassVar[tuple[int, ...]] = (2,)

    def identity(self, frame: Frame) -> Params:
        """Scale 1, nothing else."""
        return np.array([1.0, 0.0, 0.0, 0.0])

    def names(self, frame: Frame) -> tuple[str, ...]:
        """Scale, angle in radians, then the shift."""
        return ("scale", "angle_rad", "tx", "ty")

    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Scaled rotation and shift."""
        return params[0] * turn(params[1]), params[2:]

    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Derivatives by scale, angle and shift."""
        matrices = np.zeros((4, 2, 2))
        matrices[0] = turn(params[1])
        matrices[1] = params[0] * (QUARTER_TURN @ turn(params[1]))
        return matrices, np.eye(4, 2, -2)

    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """Nearest scaled rotation in the least-squares sense."""
        along = (matrix[0, 0] + matrix[1, 1]) / 2
        across = (matrix[1, 0] - matrix[0, 1]) / 2
        return np.array([np.hypot(along, across), np.arctan2(across, along), *translation])
