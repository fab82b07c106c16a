"""What all matrix-and-offset transforms share: y = M (x - centre) + centre + t, as in ITK."""

import math
from abc import abstractmethod
from typing import final

import numpy as np

from regframe.geometry import AffineMap, Frame
from regframe.transforms.base import Transform
from regframe.types import Matrix, Params, Points


def about(matrix: Matrix, translation: Params, centre: Params) -> AffineMap:
    """The map ``M (x - centre) + centre + t``, its offset summed in ITK's order."""
    offset = translation + centre
    for column in range(len(centre)):
        offset = offset - matrix[:, column] * centre[column]
    return AffineMap(matrix, offset)


def translation_about(affine: AffineMap, centre: Params) -> Params:
    """The translation that belongs to a map when it is written about `centre`."""
    return np.asarray(affine(centre[None])[0] - centre)


def turn(angle_rad: float) -> Matrix:
    """The 2-D rotation by an angle, from x towards y."""
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[cos, -sin], [sin, cos]])


class Linear(Transform):
    """A transform that is a matrix about a centre and a translation."""

    @abstractmethod
    def parts(self, params: Params, dim: int) -> tuple[Matrix, Params]:
        """Matrix (dim, dim) and translation (dim,)."""

    @abstractmethod
    def slopes(self, params: Params, dim: int) -> tuple[Matrix, Matrix]:
        """Derivatives of `parts`: (p, dim, dim) and (p, dim)."""

    @abstractmethod
    def from_parts(self, matrix: Matrix, translation: Params) -> Params:
        """Parameters of the member of this family nearest to a matrix and a translation."""

    @final
    def map(self, params: Params, points: Points, frame: Frame) -> Points:
        """Moving points of (n, dim) fixed points, physical, x first."""
        return self.as_affine(params, frame)(points)

    def as_affine(self, params: Params, frame: Frame) -> AffineMap:
        """Hook: the map as a matrix and offset, physical; by default the parts about the centre."""
        return about(*self.parts(params, frame.dim), frame.centre)

    @final
    def from_affine(self, affine: AffineMap, frame: Frame) -> Params:
        """Parameters whose map is nearest to a given one, exact at the centre."""
        return self.from_parts(affine.matrix, translation_about(affine, frame.centre))

    @final
    def parameter_gradient(self, params: Params, points: Points, forces: Points, frame: Frame) -> Params:
        """Sum over points of ``forces . d map / d params``, (p,)."""
        matrix_slopes, translation_slopes = self.slopes(params, frame.dim)
        torque = np.einsum("ni,nj->ij", forces, points - frame.centre)
        total: Params = np.einsum("pij,ij->p", matrix_slopes, torque) + translation_slopes @ forces.sum(
            axis=0
        )
        return total
