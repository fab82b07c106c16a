"""What is done to an image before registration."""

from abc import abstractmethod

from regframe.component import Component
from regframe.image import Image


class Filter(Component):
    """A small change of an image's values; grid and mask stay."""

    @abstractmethod
    def __call__(self, image: Image) -> Image:
        """The changed image; the given one is left as it is."""
