"""B-spline interpolation."""

from typing import final

import numpy as np
from pydantic import Field

from regframe.geometry import AffineMap
from regframe.interpolators.base import Interpolator, Samples
from regframe.interpolators.volumes import as_3d, kernel_matrix, kernel_samples, padded, resampled, summed
from regframe.kernels import spline, spline_plane, spline_points
from regframe.kernels.sharing import BLOCKS, share
from regframe.types import Indices, Matrix, Points, Values, Volume


@final
class BSpline(Interpolator):
    """Splines of order 0 to 5 through the pixels, mirrored at the borders.

    After Unser, Aldroubi and Eden, "B-spline signal processing: Part I and II", IEEE Transactions on
    Signal Processing 41(2), 1993; the borders, the inside rule and the order of sums are ITK's.
    """

    order: int = Field(3, ge=0, le=5, description="Degree of the polynomial pieces; 3 is the usual choice.")

    def prepare(self, volume: Volume) -> Volume:
        """Spline coefficients: the recursive prefilter along x, then y, then z."""
        return spline.prefilter(volume, self.order)

    def sample(self, coefficients: Volume, indices: Indices) -> Values:
        """Values at (n, dim) indices, array order."""
        return self.resample(coefficients, Samples(coefficients.shape, indices), None)[0]

    def gradient(self, coefficients: Volume, indices: Indices) -> Points:
        """Slopes of the spline, (n, dim), array order."""
        if self._planar(coefficients):
            plane = np.empty((len(indices), 2))
            share(spline_points.gradient, len(indices), coefficients, np.ascontiguousarray(indices), plane)
            return plane
        slopes = np.empty((len(indices), 3))
        share(spline.gradient, len(indices), as_3d(coefficients), self.order, padded(indices), slopes)
        return np.ascontiguousarray(slopes[:, 3 - indices.shape[1] :])

    def resample(
        self, coefficients: Volume, samples: Samples, index_map: AffineMap | None
    ) -> tuple[Values, Values]:
        """Values and inside weights, fused."""
        if not self._planar(coefficients):
            return resampled(spline.resample, coefficients, self.order, samples, index_map)
        values, weights = np.empty(len(samples)), np.empty(len(samples))
        matrix, indices = kernel_matrix(index_map, 2)[1:, 1:].copy(), samples.indices
        if indices is None:
            height, width = samples.shape
            share(spline_plane.resample, height, coefficients, width, matrix, values, weights)
        else:
            places = np.ascontiguousarray(indices)
            share(spline_points.resample, len(places), coefficients, places, matrix, values, weights)
        return values, weights

    def pull_back(
        self, coefficients: Volume, samples: Samples, index_map: AffineMap, forces: Values
    ) -> Matrix:
        """Derivative of ``forces . resample`` by the index map, fused."""
        if self._planar(coefficients) and samples.indices is not None:
            return super().pull_back(coefficients, samples, index_map, forces)
        grid, indices, _ = kernel_samples(samples)
        matrix, partial = kernel_matrix(index_map, coefficients.ndim), np.zeros((BLOCKS, 3, 4))
        if self._planar(coefficients):
            flat, plane = matrix[1:, 1:].copy(), partial[:, 1:, 1:].copy()
            share(spline_plane.pull_back, BLOCKS, coefficients, grid[1:].copy(), flat, forces, plane)
            partial[:, 1:, 1:] = plane
        else:
            volume = as_3d(coefficients)
            share(spline.pull_back, BLOCKS, volume, self.order, grid, indices, matrix, forces, partial)
        return summed(partial, coefficients.ndim)

    def _planar(self, coefficients: Volume) -> bool:
        """Whether the case is the one with kernels of its own: cubic, 2-D."""
        return self.order == 3 and coefficients.ndim == 2
