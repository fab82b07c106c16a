"""Windowed sinc interpolation."""

from typing import ClassVar, Literal, final

from pydantic import Field

from regframe.geometry import AffineMap
from regframe.interpolators.base import Interpolator, Samples
from regframe.interpolators.volumes import resampled
from regframe.kernels import sinc
from regframe.types import Indices, Values, Volume


@final
class WindowedSinc(Interpolator):
    """The band-limited signal through the pixels, cut at five pixels by a window.

    E. Meijering, W. Niessen, J. Pluim and M. Viergever, "Quantitative comparison of sinc-approximating
    kernels for medical image interpolation", MICCAI 1999; `itk::WindowedSincInterpolateImageFunction` with
    SimpleITK's radius. Weights are not normalised, so a constant image has ripples of up to 1 %. Slopes are
    central differences: for resampling, and slow in a search.
    """

    keeps_constants: ClassVar[bool] = False

    window: Literal["hamming", "cosine", "welch", "lanczos", "blackman"] = Field(
        "hamming", description="What the sinc is multiplied with to end at five pixels."
    )

    def sample(self, coefficients: Volume, indices: Indices) -> Values:
        """Values at (n, dim) indices, array order."""
        return self.resample(coefficients, Samples(coefficients.shape, indices), None)[0]

    def resample(
        self, coefficients: Volume, samples: Samples, index_map: AffineMap | None
    ) -> tuple[Values, Values]:
        """Values and inside weights, fused."""
        return resampled(sinc.resample, coefficients, sinc.WINDOWS.index(self.window), samples, index_map)
