"""Rotation in space alone: y = R(v) (x - c) + c."""

from typing import ClassVar, final

import numpy as np

from regframe.geometry import Frame
from regframe.transforms.linear import Linear
from regframe.transforms.rotations import (
    clipped,
    nearest_rotation,
    versor_matrix,
    versor_of,
    versor_slopes,
)
from regframe.types import Matrix, Params


@final
class Versor(Linear):
    """Rotation in 3-D about the centre: vx, vy, vz, the vector part of a unit quaternion.

    `itk::VersorTransform`, with which steps are plain sums. One departure: a vector longer than 1, which no
    unit quaternion has, counts as just under half a turn, as in `versor-rigid`; ITK raises.
    """

    dimensions: ClassVar[tuple[int, ...]] = (3,)

    def identity(self, frame: Frame) -> Params:
        """No rotation."""
        return np.zeros(3)

    def names(self, frame: Frame) -> tuple[str, ...]:
        """The versor's components."""
        return ("vx", "vy", "vz")

    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Rotation matrix, and no shift."""
        return versor_matrix(params), np.zeros(3)

    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Derivatives by the versor's components."""
        return versor_slopes(params), np.zeros((3, 3))

    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """Nearest rotation in the least-squares sense; the shift is dropped."""
        return versor_of(nearest_rotation(matrix)[0])

    def advance(self, params: Params, step: Params, frame: Frame) -> Params:
        """The sum, clipped to just under half a turn."""
        return clipped(params + step)
