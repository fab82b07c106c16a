"""Normalised gradient fields against their slow twin, and where they have nothing to say."""

from dataclasses import replace

import numpy as np
import pytest

from naive import normalised_gradient_fields as naive
from regframe.metrics.base import Pairs
from regframe.metrics.normalised_gradient_fields import NormalisedGradientFields


def pairs(shape, seed=4):
    rng = np.random.default_rng(seed)
    fixed = rng.normal(size=shape)
    moving = rng.normal(size=shape) - 0.5 * fixed
    weight = rng.choice([0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.5], shape)
    flat = [values.ravel() for values in (fixed, moving, weight)]
    return Pairs(*flat, (fixed.min(), fixed.max()), (moving.min(), moving.max()), shape)


@pytest.mark.parametrize("shape", [(9, 12), (6, 7, 9)])
@pytest.mark.parametrize("noise", [0.2, 1.0])
def test_equals_the_slow_twin(shape, noise):
    given = pairs(shape)

    value = NormalisedGradientFields(noise=noise).value(given)

    volumes = (part.reshape(shape) for part in (given.fixed, given.moving, given.weight))
    assert value == pytest.approx(naive.value(*volumes, noise), rel=1e-9)


@pytest.mark.parametrize("shape", [(9, 12), (6, 7, 9)])
def test_slope_is_that_of_the_value(shape):
    given, metric = pairs(shape), NormalisedGradientFields()

    slopes = metric.derivative(given)

    direction = np.random.default_rng(5).normal(size=slopes.size)
    ahead, behind = (metric.value(replace(given, moving=given.moving + s * direction)) for s in (1e-6, -1e-6))
    assert np.sum(slopes * direction) == pytest.approx((ahead - behind) / 2e-6, rel=1e-6)


def test_inverted_contrast_and_brightness_do_not_matter():
    given, metric = pairs((12, 12)), NormalisedGradientFields()

    inverted = replace(given, moving=7.0 - 3.0 * given.moving, moving_range=(-20.0, 20.0))

    assert metric.value(inverted) == pytest.approx(metric.value(given), rel=1e-9)


@pytest.mark.parametrize("shape", [(2, 9), (3, 3)])
def test_is_infinite_without_a_point_amid_weights(shape):
    given = replace(pairs(shape), weight=np.ones(shape).ravel())
    if shape == (3, 3):
        given.weight[1] = 0.0

    value, slopes = NormalisedGradientFields().value_and_derivative(given)

    assert value == float("inf")
    assert not slopes.any()
