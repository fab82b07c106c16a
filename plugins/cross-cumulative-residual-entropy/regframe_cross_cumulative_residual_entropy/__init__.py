"""Cross-cumulative residual entropy, a metric with a derivative for images of different modality."""

from typing import ClassVar, NamedTuple, final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from regframe import Metric, Pairs

Floats = NDArray[np.float64]
Bins = NDArray[np.int64]
FLAT = 1e-12  # below this entropy, all intensities are the same but for rounding


class _Windows(NamedTuple):
    """Four cubic windows share each moving intensity: their cells, (4, n), weights and slopes."""

    cells: Bins
    weights: Floats
    slopes: Floats


@final
class CrossCumulativeResidualEntropy(Metric):
    """Minus the dispersion of moving intensities that the fixed ones explain, from -1 to 0.

    F. Wang and B. Vemuri, "Non-rigid multi-modal image registration using cross-cumulative residual
    entropy", International Journal of Computer Vision 74(2), 2007: an entropy of the probability to be above
    a level, in place of the density. Sums of the histogram are smoother than the histogram. Windows are of
    order 3 on the moving intensities and of order 0 on the fixed ones. 0 where either image is constant.

    A departure from the paper is `normalized`, after N. Cahill, "Normalized measures of mutual information
    with general definitions of entropy for multimodal image registration", WBIR 2010.
    """

    suits: ClassVar[tuple[str, ...]] = ("mono", "inverted", "multimodal")
    invariant_to: ClassVar[tuple[str, ...]] = ("shift", "scale")

    bins: int = Field(32, ge=6, le=1024, description="Bins an axis; on the moving one, three stay free.")
    normalized: bool = Field(
        True,
        description=(
            "Divide by the moving intensities' own cumulative residual entropy; else, as in the paper, a "
            "bend that only draws rare moving intensities into the overlap counts as a better match."
        ),
    )

    def prepare(self, pairs: Pairs) -> Bins:
        """Fixed bin of every sample."""
        low, high = pairs.fixed_range
        share = (pairs.fixed - low) / (high - low or 1.0)
        return np.clip(share * self.bins, 0, self.bins - 1).astype(np.int64)

    def value(self, pairs: Pairs) -> float:
        """- sum of P(i > l, k) ln( P(i > l, k) / (P(i > l) P(k)) ) / entropy; infinite without overlap.

        Level l is a bin of the moving intensity i, and k one of the fixed intensity. The entropy is
        - sum of P(i > l) ln P(i > l), or the number of bins if not `normalized`.
        """
        return self._measured(pairs, self._windows(pairs))[0]

    def derivative(self, pairs: Pairs) -> Floats:
        """Slope of the value by each moving intensity."""
        return self.value_and_derivative(pairs)[1]

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Floats]:
        """The value and its slope, from one histogram; a bin counts in all levels below it."""
        windows = self._windows(pairs)
        value, slopes = self._measured(pairs, windows)
        below = (np.cumsum(slopes, axis=0) - slopes).ravel()
        pull = (windows.slopes * below[windows.cells]).sum(axis=0)
        return value, pull * pairs.weight / (pairs.weight.sum() or 1.0)

    def _windows(self, pairs: Pairs) -> _Windows:
        low, high = pairs.moving_range
        per_bin = (self.bins - 4) / (high - low) if high > low else 0.0
        place = 1.0 + (np.clip(pairs.moving, low, high) - low) * per_bin
        first = np.minimum(place, self.bins - 3).astype(np.int64) - 1
        t = place - first - 1.0
        weights = ((1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3)
        slopes = (-((1 - t) ** 2), 3 * t**2 - 4 * t, -3 * t**2 + 2 * t + 1, t**2)
        # Beyond the range the intensity counts as the range's end, and has no slope.
        moves = per_bin * ((pairs.moving >= low) & (pairs.moving <= high))
        fixed = pairs.prepared if isinstance(pairs.prepared, np.ndarray) else self.prepare(pairs)
        cells = (first + np.arange(4)[:, None]) * self.bins + fixed
        return _Windows(cells, np.array(weights) / 6, np.array(slopes) / 2 * moves)

    def _measured(self, pairs: Pairs, windows: _Windows) -> tuple[float, Floats]:
        """The value, and its slope by P(i > l, k), levels by rows.

        The marginals' terms cancel, so that the numerator's slope is the logarithm alone.
        """
        mass = pairs.weight.sum()
        if not mass:
            return float("inf"), np.zeros((self.bins, self.bins))
        weights = (windows.weights * pairs.weight).ravel()
        counts = np.bincount(windows.cells.ravel(), weights, minlength=self.bins**2)
        joint = counts.reshape(self.bins, self.bins) / mass
        # Added from the top, so that a level with nothing above it holds exactly nothing.
        above = np.zeros_like(joint)
        above[:-1] = np.cumsum(joint[:0:-1], axis=0)[::-1]
        tail = above.sum(axis=1, keepdims=True)
        log = _log(np.divide(above, tail * joint.sum(axis=0), out=np.ones_like(above), where=above > 0))
        explained = float((above * log).sum())
        if not self.normalized:
            return -explained / self.bins, -log / self.bins
        own = -float((tail * _log(tail)).sum())
        if own < FLAT:
            return 0.0, np.zeros_like(log)
        return -explained / own, -log / own - (explained / own**2) * (_log(tail) + 1.0)


def _log(shares: Floats) -> Floats:
    """Natural logarithm, 0 where there is nothing."""
    return np.log(shares, out=np.zeros_like(shares), where=shares > 0)
