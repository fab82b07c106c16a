"""ITK's joint histogram metric, to the letter."""

from typing import ClassVar, Literal, final

import numpy as np
from pydantic import Field

from regframe.metrics.base import Metric, Pairs
from regframe.metrics.joint_histogram import Axis, axes, counted, information, smoothed
from regframe.types import Bins, Matrix, Values

TINY = 1e-16  # ITK's own limit for probabilities under a logarithm


@final
class ItkJointHistogramMi(Metric):
    """ITK's joint histogram metric with its exchanged marginals, in bits: to repeat ITK's results.

    JointHistogramMutualInformationImageToImageMetricv4, after Thevenaz and Unser, "Optimization of mutual
    information for multiresolution image registration", IEEE Transactions on Image Processing 9(12),
    2000. ITK divides by the fixed image's marginal at the moving bin and the other way round, so the
    value is no mutual information and does not suit images whose histograms differ; for new work take
    `joint-histogram-mi` or `mattes`. The value is infinite without any sample and when an image is
    constant. One departure from ITK: its derivative is minus ours.
    """

    bins: int = Field(20, ge=6, le=1024, description="Bins an axis; the outer two at each end stay free.")
    variance: float = Field(
        1.5, ge=0.0, le=100.0, description="Of the Gaussian that smooths the histogram, in bins squared."
    )
    slope: Literal["differences", "itk"] = Field(
        "differences",
        description=(
            "What gradient optimizers follow: differences of the value, which moves in small jumps, or ITK's "
            'formula, which is not the slope of the value (with `gradient = "filtered"`, as ITK walks).'
        ),
    )

    suits: ClassVar[tuple[str, ...]] = ("mono",)
    invariant_to: ClassVar[tuple[str, ...]] = ("shift", "scale")

    def prepare(self, pairs: Pairs) -> Bins:
        """Fixed bins of all samples."""
        return axes(pairs, self.bins)[0].nearest(pairs.fixed)

    def value(self, pairs: Pairs) -> float:
        """- 1 / ln 2 sum P(k, l) ln( P(k, l) / (pm(k) pf(l)) ), pf and pm exchanged as in ITK."""
        joint = self._joint(pairs)
        if not joint.any():
            return float("inf")
        return -information(joint, joint.sum(axis=0), joint.sum(axis=1)) / float(np.log(2.0))

    def derivative(self, pairs: Pairs) -> Values | None:
        """ITK's slope, or None for differences.

        With J and M the joint and the exchanged moving probability at a pair (linear between bins), and
        primes for differences over one bin along the moving axis, d value / d m is taken for
        w / W (J' (ln J - ln M) - ln 2 M' J / M). The width of the moving range is left out.
        """
        if self.slope == "differences":
            return None
        fixed, moving = axes(pairs, self.bins)
        felt = (pairs.weight > 0.0) & (pairs.moving >= moving.low) & (pairs.moving <= moving.high)
        felt &= fixed.nearest(pairs.fixed) >= 0
        slopes = np.zeros_like(pairs.moving)
        joint = self._joint(pairs)
        if not joint.any() or not felt.any():
            return slopes
        weight = pairs.weight[felt]
        forces = _forces(joint, fixed.scaled(pairs.fixed[felt]), moving.scaled(pairs.moving[felt]), moving)
        slopes[felt] = weight / float(weight.sum()) * forces
        return slopes

    def _joint(self, pairs: Pairs) -> Matrix:
        """The smoothed histogram, all 0 where nothing can be counted."""
        if any(axis.low == axis.high for axis in axes(pairs, self.bins)):
            return np.zeros((self.bins, self.bins))
        counts = counted(pairs, self.bins)
        return smoothed(counts / (counts.sum() or 1.0), self.variance)


def _forces(joint: Matrix, fixed: Values, moving: Values, axis: Axis) -> Values:
    """J' (ln J - ln M) - ln 2 M' J / M at scaled intensities."""
    # Where the moving probability is asked for, the fixed intensity has no say: a table of equal rows.
    tables = joint, np.broadcast_to(joint.sum(axis=1), joint.shape)
    ends = [np.clip(moving + side * axis.pitch, axis.pitch, 1.0) for side in (-0.5, 0.5)]
    reach = ends[1] - ends[0]
    both, both_rise = [], []
    for table in tables:
        both.append(_between(table, fixed, moving, axis))
        behind, ahead = (_between(table, fixed, end, axis) for end in ends)
        both_rise.append(np.divide(ahead - behind, reach, out=np.zeros_like(reach), where=reach > 0.0))
    (here, marginal), (rise, marginal_rise) = both, both_rise
    counts = (here > TINY) & (marginal > TINY)
    here, marginal = np.where(counts, here, 1.0), np.where(counts, marginal, 1.0)
    force = rise * (np.log(here) - np.log(marginal)) - np.log(2.0) * marginal_rise * here / marginal
    return np.where(counts, force, 0.0)


def _between(table: Matrix, fixed: Values, moving: Values, axis: Axis) -> Values:
    """Linear interpolation between the centres of four bins."""
    rows, columns = (np.clip(axis.places(shares), 0.0, axis.bins - 1.0) for shares in (fixed, moving))
    row, column = (np.minimum(place.astype(np.int64), axis.bins - 2) for place in (rows, columns))
    down, across = rows - row, columns - column
    upper = table[row, column] * (1.0 - across) + table[row, column + 1] * across
    lower = table[row + 1, column] * (1.0 - across) + table[row + 1, column + 1] * across
    return np.asarray(upper * (1.0 - down) + lower * down)
