"""What a metric's value costs a sample, beside `mean-squares` in the same run."""

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from regframe.metrics.base import Metric, Pairs
from regframe.metrics.mean_squares import MeanSquares
from regframe.testing.metric_checks import prepared
from regframe.testing.phantoms import smooth_pair

SHAPE = (240, 320)
ROUNDS = 5


@dataclass(frozen=True)
class Cost:
    """Time of one `value`.

    Parameters
    ----------
    nanoseconds : float
        A sample.
    ratio : float
        To mean squares, timed in turn with it.
    """

    nanoseconds: float
    ratio: float


def cost(metric: Metric) -> Cost:
    """Time `value` on the pairs of a small frame, the best of a few rounds; preparation is not counted.

    Examples
    --------
    >>> 0 < cost(MeanSquares()).ratio < 20
    True
    """
    pair = smooth_pair("multimodal", SHAPE)
    fixed, moving = (np.asarray(image.values, np.float64).ravel() for image in (pair.fixed, pair.moving))
    pairs = Pairs(fixed, moving, np.ones_like(fixed), pair.fixed.range(), pair.moving.range(), SHAPE)
    tasks = [(each, prepared(each, pairs)) for each in (metric, MeanSquares())]
    for each, ready in tasks:
        each.value(ready)  # what is compiled at the first call is no cost of the later ones
    spans = np.array([[_seconds(each, ready) for each, ready in tasks] for _ in range(ROUNDS)])
    mine, plain = map(float, spans.min(axis=0))
    return Cost(1e9 * mine / len(fixed), mine / plain)


def _seconds(metric: Metric, pairs: Pairs) -> float:
    began = perf_counter()
    metric.value(pairs)
    return perf_counter() - began
