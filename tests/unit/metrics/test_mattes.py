"""Mattes mutual information against its slow twin, and where it has nothing to say."""

import numpy as np
import pytest

from naive import mattes as naive
from regframe.metrics.base import Pairs
from regframe.metrics.mattes import Mattes


def pairs(seed, count=400):
    rng = np.random.default_rng(seed)
    fixed = rng.uniform(-3, 9, count)
    moving = np.round(40 * np.sin(fixed) + rng.normal(size=count) * 5)
    weight = rng.choice([0.0, 0.5, 1.0, 2.0], count)
    return Pairs(fixed, moving, weight, (-3.0, 9.0), (-40.0, 40.0))


@pytest.mark.parametrize("bins", [8, 17, 50])
@pytest.mark.parametrize("seed", [1, 2])
def test_equals_the_slow_twin(bins, seed):
    given = pairs(seed)

    value = Mattes(bins=bins).value(given)

    expected = naive.value(
        given.fixed, given.moving, given.weight, given.fixed_range, given.moving_range, bins
    )
    assert value == pytest.approx(expected, rel=1e-12)


def test_ignores_values_beyond_the_range():
    given = pairs(1)
    beyond = np.where(np.arange(400) % 7 == 0, 40.5, given.moving)
    without = np.where(np.arange(400) % 7 == 0, 0.0, given.weight)

    value = Mattes().value(Pairs(given.fixed, beyond, given.weight, (-3.0, 9.0), (-40.0, 40.0)))

    assert value == Mattes().value(Pairs(given.fixed, given.moving, without, (-3.0, 9.0), (-40.0, 40.0)))


def test_is_infinite_without_weight():
    given = pairs(1)

    value, slopes = Mattes().value_and_derivative(
        Pairs(given.fixed, given.moving, np.zeros(400), (-3.0, 9.0), (-40.0, 40.0))
    )

    assert value == float("inf")
    assert not slopes.any()
