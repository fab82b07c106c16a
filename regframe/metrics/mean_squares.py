"""Mean of squared differences."""

from typing import ClassVar, final

import numpy as np

from regframe.metrics.base import Metric, Pairs
from regframe.types import Values


@final
class MeanSquares(Metric):
    """Weighted mean of (fixed - moving)^2: for images of one modality with equal brightness.

    Brown, "A survey of image registration techniques", ACM Computing Surveys 24(4), 1992. ITK's
    derivative is minus ours.
    """

    suits: ClassVar[tuple[str, ...]] = ("mono",)

    def value(self, pairs: Pairs) -> float:
        """sum of w (f - m)^2 / sum of w, infinite without weight."""
        mass = float(pairs.weight.sum())
        difference = pairs.difference()
        return float(np.sum(pairs.weight * difference * difference)) / mass if mass else float("inf")

    def derivative(self, pairs: Pairs) -> Values:
        """Slope by each moving intensity: -2 w (f - m) / sum of w."""
        mass = float(pairs.weight.sum())
        return (-2.0 / mass if mass else 0.0) * pairs.weight * pairs.difference()
