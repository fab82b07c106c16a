"""Mutual information of a smoothed joint histogram."""

from typing import ClassVar, final

from pydantic import Field

from regframe.metrics.base import Metric, Pairs
from regframe.metrics.joint_histogram import axes, counted, information, smoothed
from regframe.types import Bins


@final
class JointHistogramMi(Metric):
    """Negative mutual information of a smoothed joint histogram, in nats.

    After Thevenaz and Unser, "Optimization of mutual information for multiresolution image
    registration", IEEE Transactions on Image Processing 9(12), 2000, on the histogram of ITK's
    JointHistogramMutualInformationImageToImageMetricv4: whole counts, smoothed by a discrete Gaussian.
    Departures from ITK: the marginals belong to their own images (ITK exchanges them, see
    `itk-joint-histogram-mi`), the smoothed histogram sums to 1, and the value is in nats, not in bits.
    Whole counts change in jumps, so there is no slope and the engine takes differences; `mattes` has
    one. Without any sample the value is infinite.
    """

    bins: int = Field(20, ge=6, le=1024, description="Bins an axis; the outer two at each end stay free.")
    variance: float = Field(
        1.5, ge=0.0, le=100.0, description="Of the Gaussian that smooths the histogram, in bins squared."
    )

    suits: ClassVar[tuple[str, ...]] = ("mono", "inverted", "multimodal")
    invariant_to: ClassVar[tuple[str, ...]] = ("shift", "scale", "inversion")

    def prepare(self, pairs: Pairs) -> Bins:
        """Fixed bins of all samples."""
        return axes(pairs, self.bins)[0].nearest(pairs.fixed)

    def value(self, pairs: Pairs) -> float:
        """- sum P(k, l) ln( P(k, l) / (pf(k) pm(l)) ), infinite without weight."""
        joint = counted(pairs, self.bins)
        if not joint.any():
            return float("inf")
        joint = smoothed(joint / joint.sum(), self.variance)
        joint /= joint.sum()  # repeated edges can add a little
        return -information(joint, joint.sum(axis=1), joint.sum(axis=0))
