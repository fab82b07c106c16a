"""The metric beside its formula, class by class."""

import numpy as np
import pytest

from regframe import Pairs
from regframe.testing.metric_checks import example_pairs
from regframe_correlation_ratio import CorrelationRatio


def slowly(pairs: Pairs, bins: int) -> float:
    """1 - eta of Roche et al. (1998): variance left within classes of fixed intensity, over all of it."""
    low, high = pairs.fixed_range
    classes: dict[int, list[tuple[float, float]]] = {}
    for fixed, moving, weight in zip(pairs.fixed, pairs.moving, pairs.weight, strict=True):
        label = min(int((fixed - low) / (high - low) * bins), bins - 1)
        classes.setdefault(label, []).append((moving, weight))
    everything = [member for members in classes.values() for member in members]
    return sum(map(spread, classes.values())) / spread(everything)


def spread(members: list[tuple[float, float]]) -> float:
    """Weighted sum of squared distances from the weighted mean."""
    mass = sum(weight for _, weight in members)
    mean = sum(weight * moving for moving, weight in members) / mass if mass else 0.0
    return sum(weight * (moving - mean) ** 2 for moving, weight in members)


@pytest.mark.parametrize("bins", [4, 64, 200])
@pytest.mark.parametrize("kind", ["mono", "inverted", "multimodal"])
def test_value_is_that_of_its_slow_twin(kind, bins):
    pairs = example_pairs(kind, (1, 2))

    # Sums of squares less squared sums lose some four digits to the rounding of 16.
    assert CorrelationRatio(bins=bins).value(pairs) == pytest.approx(slowly(pairs, bins), rel=1e-10)


def test_weights_that_are_no_whole_numbers_count_as_they_are():
    pairs = example_pairs("multimodal")
    weight = np.random.default_rng(5).random(len(pairs.weight))
    pairs = Pairs(pairs.fixed, pairs.moving, weight, pairs.fixed_range, pairs.moving_range)

    assert CorrelationRatio().value(pairs) == pytest.approx(slowly(pairs, 64), rel=1e-10)
