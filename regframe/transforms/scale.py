"""Scaling along the axes: y = S (x - c) + c."""

from typing import final

import numpy as np

from regframe.geometry import Frame
from regframe.transforms.linear import Linear
from regframe.types import Matrix, Params


@final
class Scale(Linear):
    """Stretching along each physical axis about the centre: sx, sy (, sz); `itk::ScaleTransform`."""

    def identity(self, frame: Frame) -> Params:
        """Scale 1 along every axis."""
        return np.ones(frame.dim)

    def names(self, frame: Frame) -> tuple[str, ...]:
        """Scale along x, y (and z)."""
        return ("scale_x", "scale_y", "scale_z")[: frame.dim]

    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Diagonal matrix, and no shift."""
        return np.diag(params), np.zeros(dim)

    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Derivatives by the scales."""
        matrices = np.zeros((dim, dim, dim))
        matrices[np.arange(dim), np.arange(dim), np.arange(dim)] = 1.0
        return matrices, np.zeros((dim, dim))

    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """The diagonal, which is nearest in the least-squares sense; the shift is dropped."""
        return np.diag(matrix).copy()
