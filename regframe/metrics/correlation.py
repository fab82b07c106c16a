"""Squared correlation."""

from typing import ClassVar, final

import numpy as np

from regframe.metrics.base import Metric, Pairs
from regframe.types import Values

EPSILON = float(np.finfo(np.float64).eps)


@final
class Correlation(Metric):
    """Minus the squared correlation coefficient, in [-1, 0]: for linearly related intensities.

    Brown, "A survey of image registration techniques", ACM Computing Surveys 24(4), 1992. Squared as in
    ITK, so inverted contrast matches as well as equal contrast; ITK's derivative is minus ours. Constant
    intensities give 0.
    """

    suits: ClassVar[tuple[str, ...]] = ("mono", "inverted")
    invariant_to: ClassVar[tuple[str, ...]] = ("shift", "scale", "inversion")

    def value(self, pairs: Pairs) -> float:
        """- cov(f, m)^2 / (var(f) var(m)), infinite without weight."""
        moments = _moments(pairs)
        if moments is None:
            return float("inf")
        _, _, covariance, fixed_power, moving_power = moments
        both = fixed_power * moving_power
        return -covariance * covariance / both if both > EPSILON else 0.0

    def derivative(self, pairs: Pairs) -> Values:
        """Slope by each moving intensity: -2 w cov / (vf vm) (f' - cov / vm m'), primes about the mean."""
        moments = _moments(pairs)
        if moments is None or moments[3] * moments[4] <= EPSILON:
            return np.zeros_like(pairs.moving)
        fixed, moving, covariance, fixed_power, moving_power = moments
        factor = -2.0 * covariance / (fixed_power * moving_power)
        return factor * pairs.weight * (fixed - covariance / moving_power * moving)


def _moments(pairs: Pairs) -> tuple[Values, Values, float, float, float] | None:
    """Both intensities about their means, and their weighted sums of products.

    Sums are numpy's, not BLAS dot products: those change with the number of threads.
    """
    mass = float(pairs.weight.sum())
    if not mass:
        return None
    fixed = pairs.fixed - float(np.sum(pairs.weight * pairs.fixed)) / mass
    moving = pairs.moving - float(np.sum(pairs.weight * pairs.moving)) / mass
    weighted = pairs.weight * moving
    covariance, moving_power = float(np.sum(weighted * fixed)), float(np.sum(weighted * moving))
    return fixed, moving, covariance, float(np.sum(pairs.weight * fixed * fixed)), moving_power
