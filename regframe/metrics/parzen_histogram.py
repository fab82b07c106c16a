"""Joint histograms with a cubic window on the moving intensities, shared by the metrics made of them."""

from typing import NamedTuple

import numpy as np

from regframe.kernels import parzen
from regframe.kernels.sharing import BLOCKS, share
from regframe.metrics.base import Pairs
from regframe.types import Cells, Mask, Matrix, Values

PADDING = 2  # bins left free at each end, so that the cubic window always fits


class Axes(NamedTuple):
    """The histogram's two axes: what `prepare` computes once a level."""

    rows: Cells  # (n,) bins * fixed bin of every sample
    moving: Values  # lowest value, highest value, 1 / bin width, minimum in bins


def axes(pairs: Pairs, bins: int) -> Axes:
    """Fixed bins of all samples and the moving axis.

    With bin width h = (max - min) / (bins - 4) and m = min / h - 2, a value v lies v / h - m bins along its
    axis. Fixed bins divide, as ITK does: integer grey levels fall exactly on bin edges, where the last bit
    decides.
    """
    low, high = pairs.fixed_range
    width, last = (high - low) / (bins - 2 * PADDING) or 1.0, bins - PADDING - 1
    place = pairs.fixed / width - (low / width - PADDING)
    fixed = np.clip(np.trunc(place), PADDING, last).astype(np.int32)
    low, high = pairs.moving_range
    width = (high - low) / (bins - 2 * PADDING) or 1.0
    return Axes(fixed * bins, np.array([low, high, 1.0 / width, low / width - PADDING]))


def prepared(pairs: Pairs, bins: int) -> Axes:
    """The axes that `prepare` left, or new ones."""
    return pairs.prepared if isinstance(pairs.prepared, Axes) else axes(pairs, bins)


def joint_of(pairs: Pairs, bins: int) -> tuple[Matrix, float]:
    """Joint probability, (bins, bins), fixed by rows; and the weight of all samples that count."""
    # Not zeroed here: fresh pages cost as much as the sums, a block that was used before costs nothing.
    partial = np.empty((BLOCKS, bins * bins, 4))
    joint = np.zeros((bins, bins))
    share(parzen.moments, BLOCKS, pairs.moving, pairs.weight, *prepared(pairs, bins), bins, partial)
    parzen.histogram(partial, bins, joint)
    mass = float(joint.sum())
    return joint / (mass or 1.0), mass


def slopes_of(pairs: Pairs, bins: int, cells: Matrix, mass: float) -> Values:
    """Slope by each moving intensity, (n,), of a number with slope `cells` by each joint probability.

    With t the sample's place along the moving axis, h a bin's width and W the weight of all samples,
    slope = w / (h W) sum over l of (d window(l) / d t) cells(k, l). Four bins share a sample; their windows'
    slopes are polynomials in t (1, t, t^2).
    """
    found, slopes = prepared(pairs, bins), np.empty_like(pairs.moving)
    first, second, third, fourth = (np.roll(cells, shift, axis=1) for shift in (1, 0, -1, -2))
    table = np.stack(
        [
            0.5 * (third - first),
            first - 2.0 * second + third,
            0.5 * (fourth - first) + 1.5 * (second - third),
        ],
        axis=-1,
    ).reshape(-1, 3)
    table *= found.moving[2] / mass if mass else 0.0
    share(parzen.slopes, len(slopes), pairs.moving, pairs.weight, *found, bins, table, slopes)
    return slopes


def counts(joint: Matrix) -> Mask:
    """Cells that ITK counts: it, its row and its column hold more than rounding noise."""
    fixed, moving = joint.sum(axis=1, keepdims=True), joint.sum(axis=0)
    return np.asarray((joint > parzen.EPSILON) & (fixed > parzen.EPSILON) & (moving > parzen.EPSILON))
