"""Translation: y = x + t."""

from typing import final

import numpy as np

from regframe.geometry import AffineMap, Frame
from regframe.transforms.linear import Linear
from regframe.types import Matrix, Params


@final
class Translation(Linear):
    """Shift along each axis: parameters tx, ty (, tz); `itk::TranslationTransform`."""

    def identity(self, frame: Frame) -> Params:
        """No shift."""
        return np.zeros(frame.dim)

    def names(self, frame: Frame) -> tuple[str, ...]:
        """Shift along x, y (and z)."""
        return ("tx", "ty", "tz")[: frame.dim]

    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Identity matrix and the shift."""
        return np.eye(dim), params

    def as_affine(self, params: Params, frame: Frame) -> AffineMap:
        """The shift itself: going to the centre and back, as the other families do, would cost a bit."""
        return AffineMap(np.eye(frame.dim), params.copy())

    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Unit shifts."""
        return np.zeros((dim, dim, dim)), np.eye(dim)

    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """The shift at the centre; the matrix is dropped."""
        return translation.copy()
