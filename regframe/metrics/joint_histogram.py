"""ITK's smoothed joint histogram, on which two metrics stand."""

from typing import NamedTuple

import numpy as np

from regframe.kernels.discrete import window
from regframe.metrics.base import Pairs
from regframe.types import Bins, Mask, Matrix, Values

EPSILON = float(np.finfo(np.float64).eps)
PADDING = 2  # bins left free at each end, for the smoothing
MISSING = float(np.float32(0.01))  # share of the window's mass that may be left off
LONGEST = 32  # taps on one side of the window, at most


class Axis(NamedTuple):
    """One axis of the histogram: bins of width `pitch` over intensities scaled to 0 ... 1."""

    low: float
    high: float
    bins: int

    @property
    def pitch(self) -> float:
        """Width of a bin, as a share of the range."""
        return 1.0 / (self.bins - 2 * PADDING - 1)

    def scaled(self, intensities: Values) -> Values:
        """Intensities as shares of the range; all 0 where the range is a point."""
        width = self.high - self.low
        return (intensities - self.low) / width if width else np.zeros_like(intensities)

    def places(self, shares: Values) -> Values:
        """Continuous bins of scaled intensities; a bin's centre is a whole number."""
        return (shares + PADDING * self.pitch) * (1.0 / self.pitch)

    def nearest(self, intensities: Values) -> Bins:
        """The bin of each intensity, -1 where it is outside the histogram."""
        place = np.floor(self.places(self.scaled(intensities)) + 0.5)
        return np.where((place >= 0) & (place < self.bins), place, -1.0).astype(np.int64)


def axes(pairs: Pairs, bins: int) -> tuple[Axis, Axis]:
    """The fixed and the moving axis."""
    return Axis(*pairs.fixed_range, bins), Axis(*pairs.moving_range, bins)


def counted(pairs: Pairs, bins: int) -> Matrix:
    """Weight of the pairs in each cell, (bins, bins), fixed by rows."""
    of_fixed, of_moving = axes(pairs, bins)
    ready = pairs.prepared
    fixed = ready if isinstance(ready, np.ndarray) else of_fixed.nearest(pairs.fixed)
    moving = of_moving.nearest(pairs.moving)
    inside = (fixed >= 0) & (moving >= 0)
    cells = np.where(inside, fixed * bins + moving, 0)
    counts = np.bincount(cells, np.where(inside, pairs.weight, 0.0), bins * bins)
    return np.asarray(counts.reshape(bins, bins), np.float64)


def smoothed(joint: Matrix, variance: float) -> Matrix:
    """A histogram after the discrete Gaussian of a variance, in bins, along both axes; edges repeat."""
    taps = window(variance, MISSING, LONGEST)
    for axis in (0, 1):
        lines = np.pad(np.moveaxis(joint, axis, -1), ((0, 0), (len(taps) - 1,) * 2), mode="edge")
        result = np.zeros_like(joint)
        for shift in range(2 * len(taps) - 1):
            result += taps[abs(shift - len(taps) + 1)] * lines[:, shift : shift + joint.shape[axis]]
        joint = np.ascontiguousarray(np.moveaxis(result, -1, axis))
    return joint


def information(joint: Matrix, rows: Values, columns: Values) -> float:
    """sum of P(k, l) ln( P(k, l) / (rows(k) columns(l)) ) in nats, over the cells that ITK counts."""
    independent = np.outer(rows, columns)
    ratio = np.divide(joint, independent, out=np.zeros_like(joint), where=independent > EPSILON)
    counts: Mask = ratio > EPSILON
    return float(np.sum(joint[counts] * np.log(ratio[counts])))
