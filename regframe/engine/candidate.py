"""Places that a search found, and how they fared."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from regframe.engine.setting import Setting
from regframe.metrics.base import Metric
from regframe.transforms.warp import Chain, Warp


@dataclass(frozen=True, eq=False)
class Candidate:
    """A place that a search found, and how it fared on the levels it went through.

    Parameters
    ----------
    seen : Warp or Chain
        Where the search saw it, from the fixed to the moving image.
    found : Warp or Chain
        Where the last level that it went through left it.
    value : float
        The metric where it was seen, on the search's grid; lower is better.
    overlap : float
        Share of the smaller frame that lies within the larger.
    values : tuple of float
        The metric at the end of each level that it went through.
    """

    seen: Warp | Chain
    found: Warp | Chain
    value: float
    overlap: float
    values: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class Place:
    """A candidate as its stage knows it: maps from the domain, of the stage's family."""

    seen: Warp
    found: Warp
    value: float = float("nan")
    overlap: float = float("nan")
    values: tuple[float, ...] = ()

    def walked(self, warp: Warp, value: float) -> Self:
        """The place after one more level."""
        return replace(self, found=warp, values=(*self.values, value))

    def rank(self, metric: Metric) -> float:
        """What places are sorted by, lower first: the value, less sure where little overlaps.

        By chance alone the correlation of n independent points strays from 0 by 1 / sqrt(n).
        """
        value = self.values[-1] if self.values else self.value
        if metric.unrelated is None or not np.isfinite(self.overlap):
            return value
        return metric.unrelated + (value - metric.unrelated) * float(np.sqrt(self.overlap))

    def candidate(self, setting: Setting) -> Candidate:
        """The same with the whole ways from the fixed to the moving image."""
        whole = setting.whole(self.seen), setting.whole(self.found)
        return Candidate(*whole, self.value, self.overlap, self.values)
