"""One grey value of a colour picture."""

from typing import Literal, final

from pydantic import Field

from regframe.filters.base import Filter
from regframe.image import Image, grey

CHANNELS = {"red": 0, "green": 1, "blue": 2}


@final
class Grey(Filter):
    """Takes one channel of a colour picture, or its luma; grey images pass unchanged.

    A false-colour palette that turns from blue over red to white is nearest to brightness in one of its
    channels. The channel is taken from the pixels as they were stored, so this filter comes first.
    """

    channel: Literal["luma", "red", "green", "blue"] = Field(
        "luma", description="Which: 0.299 R + 0.587 G + 0.114 B (ITU-R BT.601), or one channel."
    )

    def __call__(self, image: Image) -> Image:
        """The image with the chosen grey."""
        raw = image.raw
        if raw is None or raw.ndim == image.dim:
            return image
        return image.with_rounded(grey(raw) if self.channel == "luma" else raw[..., CHANNELS[self.channel]])
