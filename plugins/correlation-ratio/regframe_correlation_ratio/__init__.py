"""The correlation ratio, a metric for images of different modality."""

from typing import ClassVar, final

import numpy as np
from pydantic import Field

from regframe import Metric, Pairs


@final
class CorrelationRatio(Metric):
    """Share of the moving variance that the fixed intensity leaves unexplained, from 0 to 1.

    A. Roche, G. Malandain, X. Pennec and N. Ayache, "The correlation ratio as a new similarity measure for
    multimodal image registration", MICCAI 1998: 1 - eta(moving | fixed).
    """

    suits: ClassVar[tuple[str, ...]] = ("mono", "inverted", "multimodal")
    invariant_to: ClassVar[tuple[str, ...]] = ("shift", "scale", "inversion")

    bins: int = Field(64, ge=4, description="Classes of fixed intensity, equally wide.")

    def value(self, pairs: Pairs) -> float:
        """Variance within classes over variance in all; infinite without overlap or moving contrast."""
        low, high = pairs.fixed_range
        label = np.clip((pairs.fixed - low) / (high - low or 1.0) * self.bins, 0, self.bins - 1).astype(int)
        # Mass, sum and sum of squares of the moving intensities in each class.
        n, s, q = (np.bincount(label, pairs.weight * pairs.moving**k) for k in range(3))
        within, total = (q - s**2 / (n + 1e-300)).sum(), q.sum() - s.sum() ** 2 / (n.sum() + 1e-300)
        return float(within / total) if total > 1e-12 * q.sum() else float("inf")
