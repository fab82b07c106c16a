"""Rigid motion in the plane: y = R(angle) (x - c) + c + t."""

from typing import ClassVar, final

import numpy as np

from regframe.geometry import Frame
from regframe.transforms.linear import Linear, turn
from regframe.types import Matrix, Params

QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


@final
class Rigid(Linear):
    """Rotation and shift in 2-D: parameters angle (radians), tx, ty; `itk::Euler2DTransform`."""

    dimensions: ClassVar[tuple[int, ...]] = (2,)

    def identity(self, frame: Frame) -> Params:
        """No rotation, no shift."""
        return np.zeros(3)

    def names(self, frame: Frame) -> tuple[str, ...]:
        """Angle in radians, then the shift."""
        return ("angle_rad", "tx", "ty")

    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Rotation matrix and shift."""
        return turn(params[0]), params[1:]

    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Derivatives by angle and shift."""
        matrices = np.zeros((3, 2, 2))
        matrices[0] = QUARTER_TURN @ turn(params[0])
        return matrices, np.eye(3, 2, -1)

    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """Nearest rotation in the least-squares sense (orthogonal Procrustes in the plane)."""
        angle = np.arctan2(matrix[1, 0] - matrix[0, 1], matrix[0, 0] + matrix[1, 1])
        return np.array([angle, *translation])
