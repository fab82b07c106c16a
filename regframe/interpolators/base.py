"""Values of an image between its pixels."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from regframe.component import Component
from regframe.geometry import AffineMap
from regframe.types import Indices, Matrix, Points, Values, Volume


@dataclass(frozen=True, eq=False)
class Samples:
    """Where a level looks: every point of a grid, or some continuous indices of it.

    Parameters
    ----------
    shape : tuple of int
        The grid's shape, array order.
    indices : (n, dim) float64, array order, optional
        Continuous indices; None stands for the whole grid, x fastest, without storing a coordinate.
    """

    shape: tuple[int, ...]
    indices: Indices | None = None

    def __len__(self) -> int:
        """Number of samples."""
        return int(np.prod(self.shape)) if self.indices is None else len(self.indices)

    def all_indices(self) -> Indices:
        """Continuous indices, (n, dim), array order."""
        if self.indices is not None:
            return self.indices
        dim = len(self.shape)
        return np.indices(self.shape, dtype=np.float64).reshape(dim, -1).T.copy()


class Interpolator(Component):
    """Values of an image between its pixels.

    A position is inside when ``-0.5 <= index < n - 0.5`` on every axis, as in ITK.
    """

    exact: ClassVar[bool] = True
    """Whether the value at a pixel's centre is the pixel's own."""
    keeps_constants: ClassVar[bool] = True
    """Whether a constant image is constant between its pixels too."""
    additive: ClassVar[bool] = True
    """Whether a sum of images gives the sum of their values."""

    @abstractmethod
    def sample(self, coefficients: Volume, indices: Indices) -> Values:
        """Values at (n, dim) continuous indices, array order; outside positions give any finite number."""

    def prepare(self, volume: Volume) -> Volume:
        """Hook: coefficients of a level's image, computed once (a B-spline's prefilter)."""
        return volume

    def gradient(self, coefficients: Volume, indices: Indices) -> Points:
        """Hook: derivative of `sample` with respect to the index, (n, dim), array order.

        The default takes central differences of `sample`, exact for polynomials of degree 2.
        """
        step = 1e-4
        slopes = np.empty_like(indices)
        for axis in range(indices.shape[1]):
            ahead, behind = indices.copy(), indices.copy()
            ahead[:, axis] += step
            behind[:, axis] -= step
            slopes[:, axis] = (self.sample(coefficients, ahead) - self.sample(coefficients, behind)) / (
                2 * step
            )
        return slopes

    def resample(
        self, coefficients: Volume, samples: Samples, index_map: AffineMap | None
    ) -> tuple[Values, Values]:
        """Hook: values and weights at ``index_map(samples)``; the one place where speed shows.

        Parameters
        ----------
        coefficients : volume
            What `prepare` returned.
        samples : Samples
        index_map : AffineMap or None
            From the samples' index to this image's index, array order; None for "the same".

        Returns
        -------
        values, weights : (n,) float64
            Weight 1 inside and 0 outside; the value outside is 0.
        """
        indices = mapped(samples, index_map)
        inside = np.all((indices >= -0.5) & (indices < np.array(coefficients.shape) - 0.5), axis=1)
        values = np.zeros(len(indices))
        values[inside] = self.sample(coefficients, np.ascontiguousarray(indices[inside]))
        return values, inside.astype(np.float64)

    def pull_back(
        self, coefficients: Volume, samples: Samples, index_map: AffineMap, forces: Values
    ) -> Matrix:
        """Hook: derivative of ``forces . resample`` with respect to the entries of `index_map`.

        Parameters
        ----------
        forces : (n,) float64
            Derivative of some number with respect to each resampled value, 0 outside.

        Returns
        -------
        (dim, dim + 1) float64
            ``sum of forces * gradient (x) [index, 1]``: first the matrix, then the offset, array order.
        """
        felt = forces != 0.0
        start = samples.all_indices()[felt]
        slopes = self.gradient(coefficients, np.ascontiguousarray(mapped(samples, index_map)[felt]))
        pull = slopes * forces[felt, None]
        return np.column_stack([np.einsum("ni,nj->ij", pull, start), pull.sum(axis=0)])


def mapped(samples: Samples, index_map: AffineMap | None) -> Indices:
    """``index_map(samples)`` as (n, dim) indices, array order, summed x first as the kernels do."""
    indices = samples.all_indices()
    if index_map is None:
        return indices
    return np.ascontiguousarray(index_map.reversed_axes()(indices[:, ::-1])[:, ::-1])
