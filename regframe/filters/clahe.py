"""Contrast limited adaptive histogram equalisation."""

from functools import reduce
from itertools import product
from typing import NamedTuple, final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from regframe.filters.base import Filter
from regframe.image import Image

Labels = NDArray[np.int64]


class Axis(NamedTuple):
    """Along one axis: each pixel's own tile, the tile centre before it, and how far it is beyond."""

    own: Labels
    before: Labels
    beyond: NDArray[np.float64]


@final
class Clahe(Filter):
    """Equalises the histogram of every tile and blends between tiles, with a limit to the contrast.

    K. Zuiderveld, "Contrast limited adaptive histogram equalization", in Graphics Gems IV, Academic
    Press, 1994, in 2-D and 3-D. What a histogram has above the limit is spread over all bins once. Tiles
    need not divide the image evenly; one that the mask leaves empty is not changed.
    """

    tiles: int = Field(8, ge=1, le=64, description="Tiles along each axis, at most one for two pixels.")
    clip_limit: float = Field(
        2.0,
        gt=1.0,
        allow_inf_nan=False,
        description="Most pixels in a bin, as a multiple of the bins' mean: limits contrast.",
    )
    bins: int = Field(256, ge=2, le=65536, description="Bins of the histograms, over the image's range.")

    def __call__(self, image: Image) -> Image:
        """The equalised image."""
        low, high = image.range()
        if low == high:
            return image
        place = (image.values - np.float64(low)) * (self.bins / (high - low))
        labels = np.clip(place, 0, self.bins - 1).astype(np.int64)
        counts = [max(min(self.tiles, n // 2), 1) for n in labels.shape]
        axes = [_axis(n, count) for n, count in zip(labels.shape, counts, strict=True)]
        tiles = np.ravel_multi_index(np.ix_(*(axis.own for axis in axes)), counts)
        joint = tiles * self.bins + labels
        counted = joint.ravel() if image.mask is None else joint[image.mask]
        histograms = np.bincount(counted, minlength=int(np.prod(counts)) * self.bins)
        tables = self._tables(histograms.reshape(-1, self.bins).astype(np.float64)).ravel()
        shares = np.zeros(labels.shape)
        for corner in product((0, 1), repeat=labels.ndim):
            sides = list(zip(corner, axes, counts, strict=True))
            near = [np.minimum(axis.before + side, count - 1) for side, axis, count in sides]
            weights = [axis.beyond if side else 1.0 - axis.beyond for side, axis, _ in sides]
            tile = np.ravel_multi_index(np.ix_(*near), counts)
            shares += reduce(np.multiply, np.ix_(*weights)) * tables[tile * self.bins + labels]
        return image.with_rounded(low + (high - low) * shares)

    def _tables(self, histograms: NDArray[np.float64]) -> NDArray[np.float64]:
        """Share of the range that each bin of each tile is given, (tiles, bins)."""
        total = histograms.sum(axis=1, keepdims=True)
        limit = np.maximum(self.clip_limit * total / self.bins, 1.0)
        above = np.maximum(histograms - limit, 0.0).sum(axis=1, keepdims=True)
        clipped = np.minimum(histograms, limit) + above / self.bins
        unchanged = np.linspace(0.0, 1.0, self.bins)
        return np.where(total > 0, np.cumsum(clipped, axis=1) / np.maximum(total, 1.0), unchanged)


def _axis(length: int, count: int) -> Axis:
    edges = np.arange(count + 1) * length / count
    pixels = np.arange(length)
    own = np.searchsorted(edges, pixels, side="right") - 1
    place = np.clip((pixels + 0.5) * count / length - 0.5, 0.0, count - 1.0)
    before = np.floor(place).astype(np.int64)
    return Axis(own, before, place - before)
