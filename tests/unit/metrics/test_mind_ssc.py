"""Self-similarity descriptors against their slow twin, in the plane and in space."""

from dataclasses import replace

import numpy as np
import pytest

from naive import mind_ssc as naive
from regframe.metrics.base import Pairs
from regframe.metrics.mind_ssc import MindSsc

SHAPES = [(9, 11), (5, 6, 6)]


def pairs(shape, seed=4):
    rng = np.random.default_rng(seed)
    fixed = rng.normal(size=shape)
    moving = rng.normal(size=shape) - fixed
    weight = rng.choice([0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.5], shape)
    weight.flat[0] = 1.0
    flat = [values.ravel() for values in (fixed, moving, weight)]
    return Pairs(*flat, (fixed.min(), fixed.max()), (moving.min(), moving.max()), shape)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("reach", "noise"), [(1, 0.01), (2, 0.3)])
def test_equals_the_slow_twin(shape, reach, noise):
    given = pairs(shape)

    value = MindSsc(patch=0.5, reach=reach, noise=noise).value(given)

    volumes = (part.reshape(shape) for part in (given.fixed, given.moving, given.weight))
    floors = [(noise * (high - low)) ** 2 for low, high in (given.fixed_range, given.moving_range)]
    assert value == pytest.approx(naive.value(*volumes, floors, 0.5, reach), rel=1e-9)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("noise", [0.01, 0.3])  # at the second, half of the points are at the floor
def test_slope_is_that_of_the_value(shape, noise):
    given, metric = pairs(shape), MindSsc(noise=noise)

    slopes = metric.derivative(given)

    direction = np.random.default_rng(5).normal(size=slopes.size)
    ahead, behind = (metric.value(replace(given, moving=given.moving + s * direction)) for s in (1e-7, -1e-7))
    assert np.sum(slopes * direction) == pytest.approx((ahead - behind) / 2e-7, rel=1e-5)


@pytest.mark.parametrize(("shape", "channels"), [(SHAPES[0], 4), (SHAPES[1], 12)])
def test_channels(shape, channels):
    assert MindSsc().prepare(pairs(shape)).channels.shape[0] == channels


def test_does_not_notice_brightness_contrast_nor_its_sign():
    given, metric = pairs((12, 12)), MindSsc()
    low, high = given.moving_range

    inverted = replace(
        given, moving=7.0 - 3.0 * given.moving, moving_range=(7.0 - 3.0 * high, 7.0 - 3.0 * low)
    )

    assert metric.value(inverted) == pytest.approx(metric.value(given), rel=1e-9)


@pytest.mark.parametrize("threads", ["1", "3"])
def test_bits_do_not_depend_on_threads(threads, monkeypatch):
    given, metric = pairs((40, 50)), MindSsc()
    value, slopes = metric.value_and_derivative(given)

    monkeypatch.setenv("REGFRAME_THREADS", threads)
    again, others = metric.value_and_derivative(given)

    assert again == value
    assert np.array_equal(others, slopes)


def test_is_infinite_where_no_patch_is_known():
    given = replace(pairs((4, 4)), weight=np.eye(4).ravel())

    value, slopes = MindSsc(reach=4).value_and_derivative(given)

    assert value == float("inf")
    assert not slopes.any()
