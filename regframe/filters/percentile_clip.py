"""Clip at percentiles of the image's own values."""

from typing import Self, final

import numpy as np
from pydantic import Field, model_validator

from regframe.errors import ImageError
from regframe.filters.base import Filter
from regframe.image import Image


@final
class PercentileClip(Filter):
    """Clips values beyond two percentiles, so that hot and dead pixels no longer stretch the range.

    Percentiles are taken under the mask. Both limits are values that the image has, so whole numbers
    stay whole.
    """

    low: float = Field(0.5, ge=0.0, lt=100.0, description="Percentile below which values are raised to it.")
    high: float = Field(99.5, gt=0.0, le=100.0, description="Percentile above which values are cut to it.")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.low >= self.high:
            message = f"`low` must be below `high`. Got {self.low:g} and {self.high:g}. Write 1 and 99, say."
            raise ValueError(message)
        return self

    def __call__(self, image: Image) -> Image:
        """The clipped image."""
        values = image.values if image.mask is None else image.values[image.mask]
        low = np.percentile(values, self.low, method="lower")
        high = np.percentile(values, self.high, method="higher")
        if low == high and values.min() < values.max():
            message = (
                f"{image.name}: percentiles {self.low:g} and {self.high:g} are both {low:g}, so clipping "
                "there leaves one value. Widen percentile-clip."
            )
            raise ImageError(message)
        return image.with_rounded(np.clip(image.values, low, high))
