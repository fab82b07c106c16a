"""Nearest neighbour."""

from typing import final

import numpy as np

from regframe.geometry import AffineMap
from regframe.interpolators.base import Interpolator, Samples
from regframe.interpolators.volumes import resampled
from regframe.kernels import linear
from regframe.types import Indices, Points, Values, Volume


@final
class Nearest(Interpolator):
    """The value of the nearest pixel; a tie takes the higher index, as in ITK."""

    def sample(self, coefficients: Volume, indices: Indices) -> Values:
        """Values at (n, dim) indices, array order."""
        return resampled(linear.resample, coefficients, 0, Samples(coefficients.shape, indices), None)[0]

    def gradient(self, coefficients: Volume, indices: Indices) -> Points:
        """Zero: the interpolation is flat but for its jumps."""
        return np.zeros_like(indices)

    def resample(
        self, coefficients: Volume, samples: Samples, index_map: AffineMap | None
    ) -> tuple[Values, Values]:
        """Values and inside weights, fused."""
        return resampled(linear.resample, coefficients, 0, samples, index_map)
