"""Mattes mutual information."""

from typing import ClassVar, Literal, NamedTuple, final

import numpy as np
from pydantic import Field

from regframe.kernels import parzen
from regframe.kernels.jit import BLOCKS, share
from regframe.metrics.base import Metric, Pairs
from regframe.types import Bins, Mask, Matrix, Values

EPSILON = float(np.finfo(np.float64).eps)
PADDING = 2  # bins left free at each end, so that the cubic window always fits


class Axes(NamedTuple):
    """The histogram's two axes: what `prepare` computes once a level."""

    rows: Bins  # (n,) bins * fixed bin of every sample
    moving: Values  # lowest value, highest value, 1 / bin width, minimum in bins


@final
class Mattes(Metric):
    """Negative mutual information of a Parzen-windowed joint histogram, in nats.

    After Mattes, Haynor, Vesselle, Lewellen and Eubank, "PET-CT image registration in the chest using
    free-form deformations", IEEE Transactions on Medical Imaging 22(1), 2003: windows of order 0 on the
    fixed and order 3 on the moving intensities. As in ITK, a moving value outside the range of the
    moving image's pixels (a spline's overshoot) does not count. Departures from ITK: its derivative is
    minus ours, and without any sample the value is infinite instead of an error.
    """

    bins: int = Field(50, ge=5, le=1024, description="Bins an axis; the outer two at each end stay free.")

    range_of: ClassVar[Literal["image", "samples"]] = "samples"
    suits: ClassVar[tuple[str, ...]] = ("mono", "inverted", "multimodal")

    def prepare(self, pairs: Pairs) -> Axes:
        """Fixed bins of all samples and the moving axis.

        With bin width h = (max - min) / (bins - 4) and m = min / h - 2, a value v lies v / h - m bins
        along its axis. Fixed bins divide, as ITK does: integer grey levels
        fall exactly on bin edges, where the last bit decides.
        """
        low, high = pairs.fixed_range
        width, last = (high - low) / (self.bins - 2 * PADDING) or 1.0, self.bins - PADDING - 1
        place = pairs.fixed / width - (low / width - PADDING)
        fixed = np.clip(np.trunc(place), PADDING, last).astype(np.int64)
        low, high = pairs.moving_range
        width = (high - low) / (self.bins - 2 * PADDING) or 1.0
        return Axes(fixed * self.bins, np.array([low, high, 1.0 / width, low / width - PADDING]))

    def value(self, pairs: Pairs) -> float:
        """Negative mutual information.

        With P(k, l) the share of all windows that falls into fixed bin k and moving bin l, and pf and pm
        its sums by row and column:
        value = - sum P(k, l) ln( P(k, l) / (pf(k) pm(l)) ).
        """
        return _negative_information(self._joint(pairs)[0])

    def derivative(self, pairs: Pairs) -> Values:
        """Slope of the value by each moving intensity."""
        return self.value_and_derivative(pairs)[1]

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Values]:
        """The value, and its slope by each moving intensity, from one histogram.

        The marginals' terms cancel, so only the window's own slope remains (Thevenaz and Unser,
        "Optimization of mutual information for multiresolution image registration", IEEE Transactions on
        Image Processing 9(12), 2000): with t the sample's place along the moving axis and W the weight of
        all samples, d value / d m = - w / (h W) sum over l of (d window(l) / d t) ln( P(k, l) / pm(l) ).
        """
        joint, mass = self._joint(pairs)
        axes, slopes = self._axes(pairs), np.empty_like(pairs.moving)
        log = np.log(np.divide(joint, joint.sum(axis=0), out=np.ones_like(joint), where=_counts(joint)))
        # Four bins share a sample; their windows' slopes are polynomials in t (1, t, t^2).
        first, second, third, fourth = (np.roll(log, shift, axis=1) for shift in (1, 0, -1, -2))
        table = np.stack(
            [
                0.5 * (third - first),
                first - 2.0 * second + third,
                0.5 * (fourth - first) + 1.5 * (second - third),
            ],
            axis=-1,
        ).reshape(-1, 3)
        table *= -axes.moving[2] / mass if mass else 0.0
        share(parzen.slopes, len(slopes), pairs.moving, pairs.weight, *axes, self.bins, table, slopes)
        return _negative_information(joint), slopes

    def _axes(self, pairs: Pairs) -> Axes:
        return pairs.prepared if isinstance(pairs.prepared, Axes) else self.prepare(pairs)

    def _joint(self, pairs: Pairs) -> tuple[Matrix, float]:
        """Joint probability, (bins, bins), fixed by rows; and the weight of all samples that count."""
        # Not zeroed here: fresh pages cost as much as the sums, a block that was used before costs nothing.
        partial = np.empty((BLOCKS, self.bins * self.bins, 4))
        joint = np.zeros((self.bins, self.bins))
        share(parzen.moments, BLOCKS, pairs.moving, pairs.weight, *self._axes(pairs), self.bins, partial)
        parzen.histogram(partial, self.bins, joint)
        mass = float(joint.sum())
        return joint / (mass or 1.0), mass


def _counts(joint: Matrix) -> Mask:
    """Cells that ITK counts: it, its row and its column hold more than rounding noise."""
    fixed, moving = joint.sum(axis=1, keepdims=True), joint.sum(axis=0)
    return np.asarray((joint > EPSILON) & (fixed > EPSILON) & (moving > EPSILON))


def _negative_information(joint: Matrix) -> float:
    counts = _counts(joint)
    if not counts.any():
        return float("inf")
    independent = np.outer(joint.sum(axis=1), joint.sum(axis=0))[counts]
    return -float(np.sum(joint[counts] * np.log(joint[counts] / independent)))
