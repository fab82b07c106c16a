"""Gaussian interpolation."""

from typing import ClassVar, final

import numpy as np
from pydantic import Field

from regframe.geometry import AffineMap
from regframe.interpolators.base import Interpolator, Samples
from regframe.interpolators.volumes import as_3d, padded, resampled
from regframe.kernels import blur
from regframe.kernels.sharing import share
from regframe.types import Indices, Points, Values, Volume


@final
class Gaussian(Interpolator):
    """Mean of the pixels near a place, weighted with a Gaussian: smooths while it interpolates.

    `itk::GaussianInterpolateImageFunction`, with the width that SimpleITK gives it. A pixel's weight is the
    Gaussian's mass over its extent. ITK's error function is an approximation, so values agree to 1e-8. The
    slope is that of the mean, without its jumps of some 1e-5 where a pixel comes within reach.
    """

    exact: ClassVar[bool] = False

    sigma: float = Field(0.8, gt=0, le=8, description="Standard deviation of the Gaussian, in pixels.")
    cutoff: float = Field(
        4.0, gt=0, le=8, description="Pixels farther away than this do not count; in standard deviations."
    )

    def sample(self, coefficients: Volume, indices: Indices) -> Values:
        """Values at (n, dim) indices, array order."""
        return self.resample(coefficients, Samples(coefficients.shape, indices), None)[0]

    def gradient(self, coefficients: Volume, indices: Indices) -> Points:
        """Slopes of the weighted mean, (n, dim), array order."""
        slopes = np.empty((len(indices), 3))
        share(blur.gradient, len(indices), as_3d(coefficients), self._setting(), padded(indices), slopes)
        return np.ascontiguousarray(slopes[:, 3 - indices.shape[1] :])

    def resample(
        self, coefficients: Volume, samples: Samples, index_map: AffineMap | None
    ) -> tuple[Values, Values]:
        """Values and inside weights, fused."""
        return resampled(blur.resample, coefficients, self._setting(), samples, index_map)

    def _setting(self) -> Values:
        return np.array([self.sigma, self.sigma * self.cutoff])
