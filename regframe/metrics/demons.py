"""Thirion's demons."""

from typing import ClassVar, final

import numpy as np
from pydantic import Field

from regframe.metrics.base import Metric, Pairs
from regframe.types import Points, Values

FLAT = 1e-9  # ITK's: a smaller denominator pushes nothing


@final
class Demons(Metric):
    """Mean squared difference, followed by pushes along the slope of the fixed image.

    Thirion, "Image matching as a diffusion process: an analogy with Maxwell's demons", Medical Image
    Analysis 2(3), 1998, in the form of ITK's DemonsImageToImageMetricv4. The value is that of
    `mean-squares`, and so is its slope by the moving intensities. Gradient optimizers follow the pushes
    instead: each is bounded, points along the slope of the fixed image, and is not divided by the number of
    samples, so a learning rate of 1 moves a point of a displacement field by its push. Departures from ITK:
    its derivative is minus ours, and ITK refuses other transforms than displacement fields, where here the
    pushes on all points are summed.
    """

    threshold: float = Field(
        1e-3, ge=0, description="A smaller difference of the two intensities pushes nothing."
    )

    suits: ClassVar[tuple[str, ...]] = ("mono",)

    def value(self, pairs: Pairs) -> float:
        """sum of w (f - m)^2 / sum of w, infinite without weight."""
        mass = float(pairs.weight.sum())
        difference = pairs.difference()
        return float(np.sum(pairs.weight * difference * difference)) / mass if mass else float("inf")

    def derivative(self, pairs: Pairs) -> Values:
        """Slope of the value by each moving intensity: -2 w (f - m) / sum of w."""
        mass = float(pairs.weight.sum())
        return (-2.0 / mass if mass else 0.0) * pairs.weight * pairs.difference()

    def forces(self, pairs: Pairs, slopes: Points, spacing: tuple[float, ...]) -> Points:
        """Uphill pushes: - (f - m) g / ((f - m)^2 / K + |g|^2), with g the fixed image's slope.

        K, the mean squared spacing of the fixed image, makes both terms of the denominator squared slopes.
        Weights count as shares of the largest.
        """
        difference = pairs.difference()
        squared = float(np.mean(np.square(spacing)))
        denominator = difference * difference / squared + np.sum(slopes * slopes, axis=1)
        pushes = (np.abs(difference) >= self.threshold) & (denominator >= FLAT)
        share = pairs.weight / (float(pairs.weight.max(initial=0.0)) or 1.0)
        strength = np.divide(difference * share, denominator, out=np.zeros_like(difference), where=pushes)
        forces: Points = -strength[:, None] * slopes
        return forces
