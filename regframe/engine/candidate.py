"""Places that a search found, and how they fared."""

import math
from dataclasses import dataclass, replace
from typing import Self

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
        Share of the smaller frame that lies within the larger, where it was found.
    values : tuple of float
        The metric at the end of each level that it went through.
    """

    seen: Warp | Chain
    found: Warp | Chain
    value: float
    overlap: float
    values: tuple[float, ...] = ()


def surely(metric: Metric, value: float, overlap: float, met: float) -> float:
    """A value that few points are less sure of: nearer to what unrelated images have.

    By chance alone the correlation of n independent points strays from 0 by 1 / sqrt(n), so that little
    overlap says less. That a frame is small to begin with counts by half the power: what is alike by
    structure strays as far however few points it holds.

    Parameters
    ----------
    metric : Metric
    value : float
    overlap, met : float
        What meets, as a share of the smaller frame and of the fixed one; NaN where nobody asked.
    """
    if metric.unrelated is None or not math.isfinite(met):
        return value
    sure = math.sqrt(overlap) * (met / overlap) ** 0.25 if overlap > 0.0 else 0.0
    return metric.unrelated + (value - metric.unrelated) * sure


@dataclass(frozen=True, eq=False)
class Place:
    """A candidate as its stage knows it: maps from the domain, of the stage's family."""

    seen: Warp
    found: Warp
    value: float = float("nan")
    overlap: float = float("nan")
    values: tuple[float, ...] = ()
    within: bool = True  # the bounds of the search
    met: float = float("nan")  # share of the fixed image

    def walked(self, warp: Warp, value: float) -> Self:
        """The place after one more level."""
        return replace(self, found=warp, values=(*self.values, value))

    def met_anew(self, shares: tuple[float, float], *, within: bool) -> Self:
        """The place with what meets where its walk led: shares of the smaller frame, of the fixed image."""
        return replace(self, overlap=shares[0], met=shares[1], within=within)

    def rank(self, metric: Metric) -> tuple[bool, float]:
        """What places are sorted by, lower first: those within bounds, then by how sure their value is."""
        value = self.values[-1] if self.values else self.value
        return not self.within, surely(metric, value, self.overlap, self.met)

    def candidate(self, setting: Setting) -> Candidate:
        """The same with the whole ways from the fixed to the moving image."""
        whole = setting.whole(self.seen), setting.whole(self.found)
        return Candidate(*whole, self.value, self.overlap, self.values)
