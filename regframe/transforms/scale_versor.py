"""Rotation, scales and shift in space: y = (R(v) + S - I) (x - c) + c + t."""

from typing import ClassVar, final

import numpy as np

from regframe.geometry import Frame
from regframe.transforms.linear import Linear
from regframe.transforms.rotations import nearest_rotation, turned, versor_matrix, versor_of, versor_slopes
from regframe.types import Matrix, Params

OFF = ~np.eye(3, dtype=bool)
ROUNDS = 50


@final
class ScaleVersor(Linear):
    """Rotation, shift and three scales in 3-D: vx, vy, vz, tx, ty, tz, scale_x, scale_y, scale_z.

    `itk::ScaleVersor3DTransform`. ITK adds the scales, less 1, to the rotation matrix where one would
    multiply, and so does this. An inverse is therefore not of this family. Versor and steps are as in
    `versor-rigid`.
    """

    dimensions: ClassVar[tuple[int, ...]] = (3,)
    closed: ClassVar[bool] = False

    def identity(self, frame: Frame) -> Params:
        """No rotation, no shift, scales 1."""
        return np.array([*np.zeros(6), *np.ones(3)])

    def names(self, frame: Frame) -> tuple[str, ...]:
        """The versor's components, the shift, the scales."""
        return ("vx", "vy", "vz", "tx", "ty", "tz", "scale_x", "scale_y", "scale_z")

    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Rotation plus scales less 1, and shift."""
        return versor_matrix(params[:3]) + np.diag(params[6:] - 1.0), params[3:6]

    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Derivatives by versor, shift and scales."""
        matrices = np.zeros((9, 3, 3))
        matrices[:3] = versor_slopes(params[:3])
        matrices[[6, 7, 8], [0, 1, 2], [0, 1, 2]] = 1.0
        return matrices, np.eye(9, 3, -3)

    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """Nearest in the least-squares sense: the versor fits what is off the diagonal, scales the rest.

        Gauss and Newton's steps from the nearest rotation, as long as they bring it nearer.
        """
        tried = best = versor_of(nearest_rotation(matrix)[0])
        least = np.inf
        for _ in range(ROUNDS):
            misfit = (matrix - versor_matrix(tried))[OFF]
            size = float(misfit @ misfit)
            if size >= least:
                break
            best, least = tried, size
            tried = tried + np.linalg.lstsq(versor_slopes(tried)[:, OFF].T, misfit)[0]
        rotation = versor_matrix(best)
        return np.concatenate([versor_of(rotation), translation, 1.0 + np.diag(matrix - rotation)])

    def advance(self, params: Params, step: Params, frame: Frame) -> Params:
        """Rotations compose, all else adds; see `turned`."""
        return turned(params, step)
