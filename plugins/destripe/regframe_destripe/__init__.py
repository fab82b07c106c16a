"""Removal of stripes, the fixed-pattern noise of thermal cameras, a filter."""

from typing import Literal, final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.ndimage import gaussian_filter1d

from regframe import Filter, Image

Floats = NDArray[np.float64]
WIDTHS = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)


@final
class Destripe(Filter):
    """Gives each column the histogram that lies midway between its neighbours': stripes vanish.

    Y. Tendero, S. Landeau and J. Gilles, "Non-uniformity correction of infrared images by midway
    equalization", Image Processing On Line 2, 2012. Columns of a scene have nearly the histograms of their
    neighbours; what differs is each column's own offset and gain, in an uncooled sensor. One frame is
    enough. Stripes belong to the sensor, so every pixel counts, whatever the mask says; a volume is taken
    slice by slice.
    """

    direction: Literal["columns", "rows", "both"] = Field(
        "columns", description="Which lines have a response of their own."
    )
    sigma: float | None = Field(
        None,
        gt=0,
        allow_inf_nan=False,
        description=(
            "Reach of the neighbourhood, in columns; none takes, of ten up to 8, the one that leaves the "
            "smallest differences between columns, as the paper does."
        ),
    )

    def __call__(self, image: Image) -> Image:
        """The image without stripes."""
        values = np.asarray(image.values, np.float64)
        if self.direction != "rows":
            values = self._evened(values)
        if self.direction != "columns":
            values = self._evened(values.swapaxes(-1, -2)).swapaxes(-1, -2)
        return image.with_rounded(values)

    def _evened(self, values: Floats) -> Floats:
        """The values after midway equalisation of the columns, slice by slice."""
        slices = [self._slice(plane) for plane in values.reshape(-1, *values.shape[-2:])]
        return np.array(slices).reshape(values.shape)

    def _slice(self, plane: Floats) -> Floats:
        order = plane.argsort(axis=0, kind="stable")
        ranked = np.take_along_axis(plane, order, axis=0)
        widths = WIDTHS if self.sigma is None else (self.sigma,)
        return min((_midway(ranked, order, width) for width in widths), key=_roughness)


def _midway(ranked: Floats, order: NDArray[np.int64], width: float) -> Floats:
    """Each pixel's value replaced by that of its rank in the mean of the neighbours' histograms."""
    evened = np.empty_like(ranked)
    np.put_along_axis(evened, order, gaussian_filter1d(ranked, width, axis=1, mode="reflect"), axis=0)
    return evened


def _roughness(plane: Floats) -> float:
    return float(np.abs(np.diff(plane, axis=1)).sum())
