"""Gaussian smoothing."""

from typing import final

from pydantic import Field

from regframe.filters.base import Filter
from regframe.image import Image


@final
class Gaussian(Filter):
    """Smooths by a Gaussian of the same physical width along every axis, as the levels of a preset do."""

    sigma: float = Field(
        1.0, gt=0.0, allow_inf_nan=False, description="Standard deviation, mm; pixels for camera images."
    )

    def __call__(self, image: Image) -> Image:
        """The smoothed image."""
        from regframe.kernels.gaussian import smooth

        sigmas = [self.sigma / spacing for spacing in reversed(image.grid.spacing)]
        return image.with_values(smooth(image.values, sigmas))
