"""Dark for bright."""

from typing import final

from regframe.filters.base import Filter
from regframe.image import Image


@final
class Invert(Filter):
    """Exchanges dark and bright: the smallest value becomes the largest, the range stays.

    For metrics that want equal contrast, where a thermal camera shows white as cold.
    """

    def __call__(self, image: Image) -> Image:
        """The inverted image."""
        low, high = image.range()
        total = image.values.dtype.type(low + high)
        return image.with_rounded(total - image.values)
