"""Correlation under Gaussian windows: against its slow twin, and where it differs from boxes."""

from dataclasses import replace

import numpy as np
import pytest

from naive import local_correlation as naive
from regframe.metrics.ants_correlation import AntsCorrelation
from regframe.metrics.base import Pairs
from regframe.metrics.local_correlation import LocalCorrelation

SHAPES = [(9, 11), (5, 6, 7)]


def pairs(shape, seed=4, *, offset=0.0):
    rng = np.random.default_rng(seed)
    fixed = rng.normal(size=shape)
    moving = offset + fixed + rng.normal(size=shape)
    weight = rng.choice([0.0, 1.0, 0.5], shape)
    flat = [values.ravel() for values in (fixed, moving, weight)]
    return Pairs(*flat, (fixed.min(), fixed.max()), (moving.min(), moving.max()), shape)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("contrast", ["any", "same", "inverted"])
def test_equals_the_slow_twin(shape, contrast):
    given = pairs(shape)

    value = LocalCorrelation(sigma=1.2, contrast=contrast, noise=0.1).value(given)

    volumes = (part.reshape(shape) for part in (given.fixed, given.moving, given.weight))
    floors = [(0.1 * (high - low)) ** 2 for low, high in (given.fixed_range, given.moving_range)]
    assert value == pytest.approx(naive.value(*volumes, floors, 1.2, contrast), rel=1e-9)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("contrast", ["any", "same", "inverted"])
def test_slope_is_that_of_the_value(shape, contrast):
    given, metric = pairs(shape), LocalCorrelation(sigma=1.2, contrast=contrast)

    slopes = metric.derivative(given)

    direction = np.random.default_rng(5).normal(size=slopes.size)
    ahead, behind = (metric.value(replace(given, moving=given.moving + s * direction)) for s in (1e-6, -1e-6))
    assert np.sum(slopes * direction) == pytest.approx((ahead - behind) / 2e-6, rel=1e-6)


def test_places_without_detail_count_nothing():
    given = pairs((20, 30))
    flat = np.where(np.arange(600) % 30 < 15, 0.0, given.fixed)
    empty = replace(given, fixed=flat, weight=np.ones(600))

    ours, theirs = (
        metric.value(empty) for metric in (LocalCorrelation(sigma=1.0), AntsCorrelation(radius=1))
    )

    half = replace(empty, weight=np.where(np.arange(600) % 30 < 15, 0.0, 1.0))
    assert ours > 0.6 * LocalCorrelation(sigma=1.0).value(half)
    assert theirs < AntsCorrelation(radius=1).value(half)


def test_a_far_mean_costs_no_digits():
    near, far = (LocalCorrelation(sigma=2.0).value(pairs((20, 20), offset=offset)) for offset in (0.0, 1e6))

    assert far == pytest.approx(near, rel=1e-8)  # 1e6 leaves 1e-10 of the intensities themselves
