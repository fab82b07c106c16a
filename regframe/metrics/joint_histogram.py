"""ITK's smoothed joint histogram, on which two metrics stand."""

from typing import NamedTuple

import numpy as np

from regframe.metrics.base import Pairs
from regframe.types import Bins, Mask, Matrix, Values

EPSILON = float(np.finfo(np.float64).eps)
PADDING = 2  # bins left free at each end, for the smoothing
MISSING = float(np.float32(0.01))  # share of the window's mass that may be left off
LONGEST = 32  # taps on one side of the window, at most
DIGITS = 10.0  # of the Bessel functions of order 2 and more
# Their approximations at orders 0 and 1, below the border and above it.
BORDER = 3.75
SMALL = (
    (1.0, 3.5156229, 3.0899424, 1.2067492, 0.2659732, 0.360768e-1, 0.45813e-2),
    (0.5, 0.87890594, 0.51498869, 0.15084934, 0.2658733e-1, 0.301532e-2, 0.32411e-3),
)
LARGE = (
    (
        *(0.39894228, 0.1328592e-1, 0.225319e-2, -0.157565e-2, 0.916281e-2),
        *(-0.2057706e-1, 0.2635537e-1, -0.1647633e-1, 0.392377e-2),
    ),
    (
        *(0.39894228, -0.3988024e-1, -0.362018e-2, 0.163801e-2, -0.1031555e-1),
        *(0.2282967e-1, -0.2895312e-1, 0.1787654e-1, -0.420059e-2),
    ),
)


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
    taps = window(variance)
    for axis in (0, 1):
        lines = np.pad(np.moveaxis(joint, axis, -1), ((0, 0), (len(taps) - 1,) * 2), mode="edge")
        result = np.zeros_like(joint)
        for shift in range(2 * len(taps) - 1):
            result += taps[abs(shift - len(taps) + 1)] * lines[:, shift : shift + joint.shape[axis]]
        joint = np.ascontiguousarray(np.moveaxis(result, -1, axis))
    return joint


def window(variance: float) -> Values:
    """The discrete Gaussian exp(-t) I_k(t) of variance t, from its centre to one side; its mass is 1.

    Lindeberg, "Scale-space for discrete signals", IEEE Transactions on Pattern Analysis and Machine
    Intelligence 12(3), 1990, cut off where ITK's GaussianOperator does.
    """
    if not variance:
        return np.ones(1)
    taps = [np.exp(-variance) * bessel(order, variance) for order in (0, 1)]
    mass = taps[0] + 2.0 * taps[1]
    while mass < 1.0 - MISSING and len(taps) <= LONGEST:
        taps.append(np.exp(-variance) * bessel(len(taps), variance))
        mass += 2.0 * taps[-1]
    return np.asarray(np.array(taps) / mass)


def bessel(order: int, at: float) -> float:
    """Modified Bessel function of the first kind, as ITK approximates it, for `at` > 0.

    Abramowitz and Stegun, "Handbook of mathematical functions", 1964, 9.8.1 to 9.8.4; downward
    recurrence from order 2 on (9.6.26). Good to 2e-7; exact ones would move the metric by 1e-9.
    """
    if order < len(SMALL):
        return _polynomial(order, at)
    total, higher, this = 0.0, 0.0, 1.0
    for k in range(2 * (order + int(DIGITS * np.sqrt(order))), 0, -1):
        higher, this = this, higher + k * (2.0 / at) * this
        if abs(this) > 1e10:
            total, higher, this = total * 1e-10, higher * 1e-10, this * 1e-10
        if k == order:
            total = higher
    return total * _polynomial(0, at) / this


def _polynomial(order: int, at: float) -> float:
    if at < BORDER:
        return at**order * _horner(SMALL[order], (at / BORDER) ** 2)
    return float(np.exp(at) / np.sqrt(at)) * _horner(LARGE[order], BORDER / at)


def _horner(factors: tuple[float, ...], at: float) -> float:
    total = 0.0
    for factor in reversed(factors):
        total = factor + at * total
    return total


def information(joint: Matrix, rows: Values, columns: Values) -> float:
    """sum of P(k, l) ln( P(k, l) / (rows(k) columns(l)) ) in nats, over the cells that ITK counts."""
    independent = np.outer(rows, columns)
    ratio = np.divide(joint, independent, out=np.zeros_like(joint), where=independent > EPSILON)
    counts: Mask = ratio > EPSILON
    return float(np.sum(joint[counts] * np.log(ratio[counts])))
