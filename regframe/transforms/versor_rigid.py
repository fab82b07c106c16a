"""Rigid motion in space: y = R(v) (x - c) + c + t."""

from typing import ClassVar, final

import numpy as np

from regframe.geometry import Frame
from regframe.transforms.linear import Linear
from regframe.transforms.rotations import nearest_rotation, turned, versor_matrix, versor_of, versor_slopes
from regframe.types import Matrix, Params


@final
class VersorRigid(Linear):
    """Rotation and shift in 3-D: vx, vy, vz, tx, ty, tz; the rotation is a versor.

    `itk::VersorRigid3DTransform`. The versor is the vector part of a unit quaternion: along the rotation's
    axis, as long as the sine of half its angle. One that is too long counts as just under half a turn.
    Gradient steps compose rotations and add all else; there a step of the versor is an axis times an angle,
    ITK's rule, which turns half as far as adding it would. One departure: a rotation composed beyond half
    a turn goes on, where ITK's turns back.
    """

    dimensions: ClassVar[tuple[int, ...]] = (3,)

    def identity(self, frame: Frame) -> Params:
        """No rotation, no shift."""
        return np.zeros(6)

    def names(self, frame: Frame) -> tuple[str, ...]:
        """The versor's components, then the shift."""
        return ("vx", "vy", "vz", "tx", "ty", "tz")

    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Rotation matrix and shift."""
        return versor_matrix(params[:3]), params[3:]

    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Derivatives by versor and shift."""
        return np.concatenate([versor_slopes(params[:3]), np.zeros((3, 3, 3))]), np.eye(6, 3, -3)

    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """Nearest rotation in the least-squares sense."""
        return np.concatenate([versor_of(nearest_rotation(matrix)[0]), translation])

    def advance(self, params: Params, step: Params, frame: Frame) -> Params:
        """Rotations compose, shifts add; see `turned`."""
        return turned(params, step)
