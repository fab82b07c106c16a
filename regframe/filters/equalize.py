"""Histogram equalisation."""

from typing import final

import numpy as np
from pydantic import Field

from regframe.filters.base import Filter
from regframe.image import Image


@final
class Equalize(Filter):
    """Gives every grey level the share of the range that its pixels have of the image.

    The share of darker pixels, under the mask, is stretched to the image's own range. Every level of
    8-, 14- and 16-bit data keeps a bin of its own at the default number of bins.
    """

    bins: int = Field(65536, ge=2, le=1 << 20, description="Bins of the histogram, over the image's range.")

    def __call__(self, image: Image) -> Image:
        """The equalised image."""
        low, high = image.range()
        if low == high:
            return image
        place = (image.values - np.float64(low)) * (self.bins / (high - low))
        labels = np.clip(place, 0, self.bins - 1).astype(np.int64)
        counted = labels.ravel() if image.mask is None else labels[image.mask]
        ranks = np.cumsum(np.bincount(counted, minlength=self.bins)).astype(np.float64)
        shares = (ranks - ranks[0]) / (ranks[-1] - ranks[0])
        return image.with_rounded((low + (high - low) * shares)[labels])
