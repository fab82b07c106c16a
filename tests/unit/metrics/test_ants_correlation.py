"""Neighbourhood correlation: its values by hand."""

import numpy as np
import pytest

from naive import ants_correlation as naive
from regframe.metrics.ants_correlation import AntsCorrelation
from regframe.metrics.base import Pairs


def pairs(shape, weight, *, offset=0.0):
    rng = np.random.default_rng(4)
    fixed = rng.normal(size=shape)
    moving = offset + fixed + rng.normal(size=shape)
    flat = [values.ravel() for values in (fixed, moving, weight)]
    return Pairs(*flat, (fixed.min(), fixed.max()), (moving.min(), moving.max()), shape)


@pytest.mark.parametrize("shape", [(9, 7), (5, 4, 6)])
@pytest.mark.parametrize("radius", [1, 2, 9])
def test_equals_the_window_by_window_value(shape, radius):
    weight = np.random.default_rng(5).choice([0.0, 1.0, 0.5], shape)
    given = pairs(shape, weight)

    value = AntsCorrelation(radius=radius).value(given)

    volumes = (part.reshape(shape) for part in (given.fixed, given.moving, given.weight))
    assert value == pytest.approx(naive.value(*volumes, radius), rel=1e-12)


def test_a_far_mean_costs_no_digits():
    shape = (20, 20)

    near, far = (
        AntsCorrelation(radius=2).value(pairs(shape, np.ones(shape), offset=offset)) for offset in (0.0, 1e6)
    )

    # 1e6 leaves 1e-10 of the intensities themselves.
    assert far == pytest.approx(near, rel=1e-8)


def test_a_lone_sample_has_no_slope():
    weight = np.zeros((6, 6))
    weight[2, 3] = 1.0

    value, slopes = AntsCorrelation(radius=1).value_and_derivative(pairs((6, 6), weight))

    assert value == -1.0
    assert not slopes.any()
