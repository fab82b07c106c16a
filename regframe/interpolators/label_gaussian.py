"""Gaussian interpolation of labels."""

from typing import ClassVar, final

import numpy as np
from pydantic import Field

from regframe.geometry import AffineMap
from regframe.interpolators.base import Interpolator, Samples
from regframe.interpolators.volumes import resampled
from regframe.kernels import blur
from regframe.types import Indices, Points, Values, Volume


@final
class LabelGaussian(Interpolator):
    """The label with most weight near a place, pixels weighted with a Gaussian: smoother than `nearest`.

    `itk::LabelImageGaussianInterpolateImageFunction`, with the width that SimpleITK gives it. For images of
    labels; every grey value counts as a label of its own.
    """

    exact: ClassVar[bool] = False
    additive: ClassVar[bool] = False

    sigma: float = Field(1.0, gt=0, le=4, description="Standard deviation of the Gaussian, in pixels.")
    cutoff: float = Field(
        1.0, gt=0, le=4, description="Pixels farther away than this do not count; in standard deviations."
    )

    def sample(self, coefficients: Volume, indices: Indices) -> Values:
        """Values at (n, dim) indices, array order."""
        return self.resample(coefficients, Samples(coefficients.shape, indices), None)[0]

    def gradient(self, coefficients: Volume, indices: Indices) -> Points:
        """Zero: the interpolation is flat but for its jumps."""
        return np.zeros_like(indices)

    def resample(
        self, coefficients: Volume, samples: Samples, index_map: AffineMap | None
    ) -> tuple[Values, Values]:
        """Values and inside weights, fused."""
        setting = np.array([self.sigma, self.sigma * self.cutoff])
        return resampled(blur.resample_labels, coefficients, setting, samples, index_map)
