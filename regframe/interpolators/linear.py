"""Linear interpolation."""

from typing import final

import numpy as np

from regframe.geometry import AffineMap
from regframe.interpolators.base import Interpolator, Samples
from regframe.interpolators.volumes import as_3d, kernel_matrix, kernel_samples, padded, resampled, summed
from regframe.kernels import linear
from regframe.kernels.sharing import BLOCKS, share
from regframe.types import Indices, Matrix, Points, Values, Volume


@final
class Linear(Interpolator):
    """Linear along x, then y, then z; constant over the outer half pixel, as in ITK."""

    def sample(self, coefficients: Volume, indices: Indices) -> Values:
        """Values at (n, dim) indices, array order."""
        return resampled(linear.resample, coefficients, 1, Samples(coefficients.shape, indices), None)[0]

    def gradient(self, coefficients: Volume, indices: Indices) -> Points:
        """Slopes of the piecewise linear surface, (n, dim), array order."""
        slopes = np.empty((len(indices), 3))
        share(linear.gradient, len(indices), as_3d(coefficients), padded(indices), slopes)
        return np.ascontiguousarray(slopes[:, 3 - indices.shape[1] :])

    def resample(
        self, coefficients: Volume, samples: Samples, index_map: AffineMap | None
    ) -> tuple[Values, Values]:
        """Values and inside weights, fused."""
        if samples.indices is None:
            grid, _, rows = kernel_samples(samples)
            values, weights = np.empty(len(samples)), np.empty(len(samples))
            matrix = kernel_matrix(index_map, coefficients.ndim)
            share(linear.resample_grid, rows, as_3d(coefficients), grid, matrix, values, weights)
            return values, weights
        return resampled(linear.resample, coefficients, 1, samples, index_map)

    def pull_back(
        self, coefficients: Volume, samples: Samples, index_map: AffineMap, forces: Values
    ) -> Matrix:
        """Derivative of ``forces . resample`` by the index map, fused."""
        grid, indices, _ = kernel_samples(samples)
        matrix, partial = kernel_matrix(index_map, coefficients.ndim), np.zeros((BLOCKS, 3, 4))
        volume = as_3d(coefficients)
        if samples.indices is None:
            share(linear.pull_back_grid, BLOCKS, volume, grid, matrix, forces, partial)
        else:
            share(linear.pull_back, BLOCKS, volume, grid, indices, matrix, forces, partial)
        return summed(partial, coefficients.ndim)
