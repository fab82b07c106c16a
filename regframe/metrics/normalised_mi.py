"""Normalised mutual information."""

from typing import ClassVar, NamedTuple, final

import numpy as np
from pydantic import Field

from regframe.metrics.base import Metric, Pairs
from regframe.metrics.parzen_histogram import Axes, axes, joint_of, slopes_of
from regframe.types import Matrix, Values


@final
class NormalisedMi(Metric):
    """Minus the sum of both entropies by the joint one, in [-2, -1].

    Studholme, Hill and Hawkes, "An overlap invariant entropy measure of 3D medical image alignment", Pattern
    Recognition 32(1), 1999: unlike mutual information, it does not grow by what the overlap happens to hold.
    The histogram is that of `mattes`, with a cubic window on the moving intensities where the paper shares
    a sample among its neighbours' bins, so that there is a slope. Without any sample the value is infinite.
    """

    bins: int = Field(50, ge=5, le=1024, description="Bins an axis; the outer two at each end stay free.")

    suits: ClassVar[tuple[str, ...]] = ("mono", "inverted", "multimodal")
    invariant_to: ClassVar[tuple[str, ...]] = ("shift", "scale", "inversion")

    def prepare(self, pairs: Pairs) -> Axes:
        """Fixed bins of all samples and the moving axis."""
        return axes(pairs, self.bins)

    def value(self, pairs: Pairs) -> float:
        """- (Hf + Hm) / Hj, with entropies H = - sum P ln P of the two marginals and of the joint."""
        return _value(_entropies(joint_of(pairs, self.bins)[0]))

    def derivative(self, pairs: Pairs) -> Values:
        """Slope of the value by each moving intensity."""
        return self.value_and_derivative(pairs)[1]

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Values]:
        """The value, and its slope by each moving intensity, from one histogram.

        The fixed marginal does not change, and all shares keep their sum, so by the joint probability
        d value / d P(k, l) = (Hj ln pm(l) - (Hf + Hm) ln P(k, l)) / Hj^2.
        """
        joint, mass = joint_of(pairs, self.bins)
        at = _entropies(joint)
        if not at.joint:
            return _value(at), np.zeros_like(pairs.moving)
        cells = (at.joint * _log(joint.sum(axis=0)) - (at.fixed + at.moving) * _log(joint)) / at.joint**2
        return _value(at), slopes_of(pairs, self.bins, cells, mass)


class Entropies(NamedTuple):
    """Of the two marginals and of the joint histogram, in nats."""

    fixed: float
    moving: float
    joint: float


def _entropies(joint: Matrix) -> Entropies:
    parts = (joint.sum(axis=1), joint.sum(axis=0), joint)
    return Entropies(*(-float(np.sum(part * _log(part))) for part in parts))


def _value(at: Entropies) -> float:
    return -(at.fixed + at.moving) / at.joint if at.joint else float("inf")


def _log(shares: Matrix) -> Matrix:
    """Logarithms, 0 for empty cells."""
    return np.log(shares, out=np.zeros_like(shares), where=shares > 0.0)
