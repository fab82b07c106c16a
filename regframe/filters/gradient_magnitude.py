"""Length of the image's gradient."""

from typing import final

import numpy as np

from regframe.errors import ImageError
from regframe.filters.base import Filter
from regframe.image import Image


@final
class GradientMagnitude(Filter):
    """Replaces values by the length of their gradient: edges, whichever side is brighter.

    Central differences in grey levels per mm (per pixel for camera images), one-sided at the border. The
    grid's direction turns a gradient and leaves its length. Noise is magnified: smooth first.
    """

    def __call__(self, image: Image) -> Image:
        """The image of gradient lengths."""
        if min(image.grid.shape) < 2:
            message = (
                f"{image.name}: gradient-magnitude needs 2 pixels along every axis. Got shape "
                f"{image.grid.shape}. Leave this filter out."
            )
            raise ImageError(message)
        total = np.zeros(image.grid.shape)
        for axis, spacing in enumerate(reversed(image.grid.spacing)):
            total += np.gradient(image.values.astype(np.float64), spacing, axis=axis) ** 2
        return image.with_rounded(np.sqrt(total))
