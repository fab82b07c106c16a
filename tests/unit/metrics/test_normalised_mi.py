"""Normalised mutual information against its slow twin, and what it promises."""

from dataclasses import replace

import numpy as np
import pytest

from naive import normalised_mi as naive
from regframe.metrics.base import Pairs
from regframe.metrics.mattes import Mattes
from regframe.metrics.normalised_mi import NormalisedMi


def pairs(seed, count=400):
    rng = np.random.default_rng(seed)
    fixed = rng.uniform(-3, 9, count)
    moving = 40 * np.sin(fixed) + rng.normal(size=count) * 5
    weight = rng.choice([0.0, 0.5, 1.0, 2.0], count)
    return Pairs(fixed, moving, weight, (-3.0, 9.0), (-40.0, 40.0))


@pytest.mark.parametrize("bins", [8, 17, 50])
@pytest.mark.parametrize("seed", [1, 2])
def test_equals_the_slow_twin(bins, seed):
    given = pairs(seed)

    value = NormalisedMi(bins=bins).value(given)

    parts = (given.fixed, given.moving, given.weight, given.fixed_range, given.moving_range)
    assert value == pytest.approx(naive.value(*parts, bins), rel=1e-12)


def test_lies_between_independence_and_identity():
    given = pairs(1, 4000)
    shuffled = replace(given, moving=np.random.default_rng(2).permutation(given.moving))

    values = [NormalisedMi(bins=12).value(one) for one in (given, shuffled)]

    assert -2.0 < values[0] < -1.1
    assert values[1] == pytest.approx(-1.0, abs=0.01)


def test_background_in_the_overlap_counts_less_than_for_mutual_information():
    """The paper's reason: more background on a misaligned pair raises mutual information, not the ratio."""
    rng = np.random.default_rng(3)
    body = rng.uniform(0.0, 1.0, 500)
    aligned = Pairs(body, body, np.ones(500), (0.0, 1.0), (0.0, 1.0))
    loose = np.clip(body + rng.normal(size=500) * 0.1, 0.0, 1.0)
    empty = np.zeros(300)
    padded = Pairs(*(np.r_[part, empty] for part in (body, loose)), np.ones(800), (0.0, 1.0), (0.0, 1.0))
    bare = Pairs(body, loose, np.ones(500), (0.0, 1.0), (0.0, 1.0))

    ratio, plain = (
        (metric.value(padded) - metric.value(bare)) / abs(metric.value(aligned))
        for metric in (NormalisedMi(bins=16), Mattes(bins=16))
    )

    assert abs(ratio) < abs(plain)


def test_is_infinite_without_weight():
    value, slopes = NormalisedMi().value_and_derivative(replace(pairs(1), weight=np.zeros(400)))

    assert value == float("inf")
    assert not slopes.any()
