"""Rigid motion: y = R (x - c) + c + t."""

from typing import final

import numpy as np
from pydantic import Field

from regframe.geometry import Frame
from regframe.transforms.linear import Linear, turn
from regframe.transforms.rotations import Order, euler, euler_angles, euler_slopes, nearest_rotation
from regframe.types import Matrix, Params

QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


@final
class Rigid(Linear):
    """Rotation by angles, in radians, and shift: angle, tx, ty; in 3-D ax, ay, az, tx, ty, tz.

    In 2-D `itk::Euler2DTransform`, in 3-D `itk::Euler3DTransform`. Turned by a quarter about its middle
    axis, a 3-D rotation by angles loses a freedom; `versor-rigid` has no such place.
    """

    order: Order = Field(
        "zxy",
        description=(
            "Order of the 3-D rotation's factors, the last one applied first: zxy is ITK's default Rz Rx Ry, "
            "zyx its ComputeZYX, Rz Ry Rx. In 2-D there is one factor."
        ),
    )

    def identity(self, frame: Frame) -> Params:
        """No rotation, no shift."""
        return np.zeros(3 if frame.dim == 2 else 6)

    def names(self, frame: Frame) -> tuple[str, ...]:
        """Angles in radians, then the shift."""
        if frame.dim == 2:
            return ("angle_rad", "tx", "ty")
        return ("angle_x_rad", "angle_y_rad", "angle_z_rad", "tx", "ty", "tz")

    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Rotation matrix and shift."""
        if dim == 2:
            return turn(params[0]), params[1:]
        return euler(params[:3], self.order), params[3:]

    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Derivatives by angles and shift."""
        matrices = np.zeros((len(params), dim, dim))
        if dim == 2:
            matrices[0] = QUARTER_TURN @ turn(params[0])
        else:
            matrices[:3] = euler_slopes(params[:3], self.order)
        return matrices, np.eye(len(params), dim, dim - len(params))

    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """Nearest rotation in the least-squares sense (orthogonal Procrustes)."""
        if len(matrix) == 2:
            angle = np.arctan2(matrix[1, 0] - matrix[0, 1], matrix[0, 0] + matrix[1, 1])
            return np.array([angle, *translation])
        return np.concatenate([euler_angles(nearest_rotation(matrix)[0], self.order), translation])
