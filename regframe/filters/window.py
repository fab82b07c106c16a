"""Clip at given values."""

from typing import Self, final

import numpy as np
from pydantic import Field, model_validator

from regframe.errors import ImageError
from regframe.filters.base import Filter
from regframe.image import Image


@final
class Window(Filter):
    """Clips values to a fixed range: a window of Hounsfield units, or of a thermal camera's counts."""

    low: float = Field(
        description="Lowest value that is kept; lower ones become it.", allow_inf_nan=False, examples=[0.0]
    )
    high: float = Field(
        description="Highest value that is kept; higher ones become it.",
        allow_inf_nan=False,
        examples=[16383.0],
    )

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if not self.low < self.high:
            message = f"`low` must be below `high`. Got {self.low:g} and {self.high:g}. Exchange them."
            raise ValueError(message)
        return self

    def __call__(self, image: Image) -> Image:
        """The clipped image."""
        least, most = image.range()
        if least >= self.high or most <= self.low:
            message = (
                f"{image.name}: no value lies inside the window from {self.low:g} to {self.high:g}; the "
                f"image's own reach from {least:g} to {most:g}. Choose a window among them."
            )
            raise ImageError(message)
        return image.with_rounded(np.clip(image.values, self.low, self.high))
