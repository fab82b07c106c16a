"""The metric beside its formula, sample by sample."""

from dataclasses import replace
from math import log

import numpy as np
import pytest

from regframe import Pairs
from regframe.testing.metric_checks import example_pairs
from regframe_cross_cumulative_residual_entropy import CrossCumulativeResidualEntropy

BINS = 12


def cubic(x: float) -> float:
    """The cubic B-spline, which is the third convolution of a box with itself."""
    away = abs(x)
    if away < 1:
        return 2 / 3 - away**2 + away**3 / 2
    return (2 - away) ** 3 / 6 if away < 2 else 0.0


def slowly(pairs: Pairs, *, normalized: bool) -> float:
    """Minus the sum over levels and fixed bins of P(i > l, k) ln( P(i > l, k) / (P(i > l) P(k)) )."""
    (low, high), (start, end) = pairs.fixed_range, pairs.moving_range
    joint = [[0.0] * BINS for _ in range(BINS)]  # moving bin, fixed bin
    for fixed, moving, weight in zip(pairs.fixed, pairs.moving, pairs.weight, strict=True):
        column = min(int((fixed - low) / (high - low) * BINS), BINS - 1)
        place = 1 + (moving - start) / (end - start) * (BINS - 4)
        for row in range(BINS):
            joint[row][column] += weight * cubic(place - row) / pairs.weight.sum()
    explained = own = 0.0
    for level in range(BINS):
        above = [sum(joint[row][k] for row in range(level + 1, BINS)) for k in range(BINS)]
        tail = sum(above)
        share = [sum(joint[row][k] for row in range(BINS)) for k in range(BINS)]
        explained += sum(p * log(p / (tail * share[k])) for k, p in enumerate(above) if p > 0)
        own -= tail * log(tail) if tail > 0 else 0.0
    return -explained / own if normalized else -explained / BINS


@pytest.mark.parametrize("normalized", [True, False])
@pytest.mark.parametrize("kind", ["mono", "inverted", "multimodal"])
def test_value_is_that_of_its_slow_twin(kind, normalized):
    pairs = example_pairs(kind, (1, 2))
    metric = CrossCumulativeResidualEntropy(bins=BINS, normalized=normalized)

    assert metric.value(pairs) == pytest.approx(slowly(pairs, normalized=normalized), rel=1e-10)


@pytest.mark.parametrize("normalized", [True, False])
def test_derivative_is_the_slope_of_the_slow_twin(normalized):
    pairs = example_pairs("multimodal", (1, 2))
    metric = CrossCumulativeResidualEntropy(bins=BINS, normalized=normalized)
    low, high = pairs.moving_range
    step = 1e-4 * (high - low)
    inner = np.flatnonzero((pairs.weight > 0) & (pairs.moving > low + step) & (pairs.moving < high - step))

    slopes = metric.derivative(pairs)

    for sample in inner[:: len(inner) // 2]:
        ahead, behind = (
            slowly(replace(pairs, moving=moved(pairs.moving, sample, by)), normalized=normalized)
            for by in (step, -step)
        )
        # One sample of 1760 moves the value by little, so that rounding shows in the sixth digit.
        assert slopes[sample] == pytest.approx((ahead - behind) / (2 * step), rel=1e-4, abs=1e-9)


def moved(moving, sample, by):
    """The intensities, one of them changed."""
    changed = moving.copy()
    changed[sample] += by
    return changed
