"""What every shipped metric may and may not notice."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from properties.strategies import floats, seeds

from regframe.catalog import METRICS
from regframe.metrics.base import Pairs

SHAPE = (10, 15)  # of the samples, for metrics that want whole grids
OPTIONS = {"sum": {"parts": ["mattes", "ants-correlation"]}}
METRICS_BY_NAME = [METRICS.build({"type": name, **OPTIONS.get(name, {})}) for name in METRICS.names()]


def each(metrics):
    return pytest.mark.parametrize("metric", metrics, ids=lambda metric: type(metric).__name__)


every = each(METRICS_BY_NAME)
loose = each([metric for metric in METRICS_BY_NAME if metric.layout == "points"])
# Values are means over a hundred or more samples.
ROUNDING = 1e-9


def draw_pairs(seed, count=150):
    """Loosely related intensities, a fifth of them weightless, the others of uneven weight."""
    rng = np.random.default_rng(seed)
    fixed = rng.uniform(0.0, 100.0, count)
    moving = 100.0 * np.sin(fixed / 40.0) + rng.normal(0.0, 10.0, count)
    weight = rng.uniform(0.5, 1.5, count) * (rng.random(count) > 0.2)
    ranges = (0.0, 100.0), (float(moving.min()), float(moving.max()))
    return Pairs(fixed, moving, weight, *ranges, SHAPE)


def value(metric, pairs):
    unseen = replace(pairs, moving=np.zeros(0), prepared=None)
    return metric.value(replace(pairs, prepared=metric.prepare(unseen)))


def slopes(metric, pairs):
    unseen = replace(pairs, moving=np.zeros(0), prepared=None)
    return metric.derivative(replace(pairs, prepared=metric.prepare(unseen)))


ITK_SLOPES = [
    METRICS.build({"type": name, "slope": "itk"}) for name in ("ants-correlation", "itk-joint-histogram-mi")
]
sloped = each([*(m for m in METRICS_BY_NAME if slopes(m, draw_pairs(1)) is not None), *ITK_SLOPES])


def same(got, wanted):
    return got == pytest.approx(wanted, rel=ROUNDING, abs=ROUNDING)


@loose
@given(seeds, st.permutations(range(150)))
def test_order_of_samples_is_not_noticed(metric, seed, order):
    pairs, order = draw_pairs(seed), np.array(order)

    mixed = replace(pairs, fixed=pairs.fixed[order], moving=pairs.moving[order], weight=pairs.weight[order])

    assert same(value(metric, mixed), value(metric, pairs))


@every
@given(seeds, floats(0.01, 100.0))
def test_scale_of_weights_is_not_noticed(metric, seed, factor):
    pairs = draw_pairs(seed)

    assert same(value(metric, replace(pairs, weight=factor * pairs.weight)), value(metric, pairs))


@loose
@given(seeds)
def test_samples_twice_are_weights_doubled(metric, seed):
    pairs = draw_pairs(seed)
    twice = {name: np.concatenate([getattr(pairs, name)] * 2) for name in ("fixed", "moving", "weight")}

    assert same(value(metric, replace(pairs, **twice)), value(metric, pairs))


@loose
@given(seeds)
def test_a_whole_weight_counts_like_so_many_samples(metric, seed):
    pairs = draw_pairs(seed)
    counts = np.random.default_rng((seed, 1)).integers(0, 4, len(pairs.fixed))

    repeated = replace(
        pairs,
        fixed=np.repeat(pairs.fixed, counts),
        moving=np.repeat(pairs.moving, counts),
        weight=np.ones(counts.sum()),
    )

    assert same(value(metric, replace(pairs, weight=counts.astype(np.float64))), value(metric, repeated))


@sloped
@given(seeds)
def test_slopes_are_zero_without_weight(metric, seed):
    pairs = draw_pairs(seed)

    assert not slopes(metric, pairs)[pairs.weight == 0].any()


@sloped
@given(seeds)
def test_slopes_do_not_notice_the_scale_of_weights(metric, seed):
    pairs = draw_pairs(seed)

    heavier = slopes(metric, replace(pairs, weight=2.5 * pairs.weight))

    wanted = slopes(metric, pairs)
    np.testing.assert_allclose(heavier, wanted, rtol=0, atol=ROUNDING * max(1.0, np.abs(wanted).max()))


@pytest.mark.parametrize("name", ["ants-correlation", "correlation", "mattes"])
@given(seeds, floats(0.1, 10.0), floats(-500.0, 500.0))
def test_statistical_metrics_ignore_brightness_and_contrast(name, seed, gain, offset):
    """A common gain and offset of the moving intensities, ranges included, changes nothing."""
    pairs = draw_pairs(seed)
    low, high = pairs.moving_range

    brighter = replace(
        pairs, moving=gain * pairs.moving + offset, moving_range=(gain * low + offset, gain * high + offset)
    )

    # The brightest sample may round to just outside the range, where Mattes leaves it out: keep it inside.
    held = np.clip(brighter.moving, *brighter.moving_range)
    got = value(METRICS.build(name), replace(brighter, moving=held))
    assert got == pytest.approx(value(METRICS.build(name), pairs), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("name", ["ants-correlation", "correlation"])
@given(seeds)
def test_correlation_does_not_notice_inverted_contrast(name, seed):
    pairs = draw_pairs(seed)
    low, high = pairs.moving_range

    inverted = replace(pairs, moving=-pairs.moving, moving_range=(-high, -low))

    assert same(value(METRICS.build(name), inverted), value(METRICS.build(name), pairs))


@pytest.mark.parametrize("name", ["ants-correlation", "correlation"])
@given(seeds)
def test_squared_correlation_lies_between_minus_one_and_zero(name, seed):
    assert -1.0 - ROUNDING <= value(METRICS.build(name), draw_pairs(seed)) <= 0.0


@given(seeds, floats(0.1, 5.0), floats(-9.0, 9.0))
def test_linearly_related_intensities_correlate_fully(seed, gain, offset):
    pairs = draw_pairs(seed)

    related = replace(pairs, moving=gain * pairs.fixed + offset)

    assert value(METRICS.build("correlation"), related) == pytest.approx(-1.0, abs=1e-9)


@pytest.mark.parametrize("name", ["joint-histogram-mi", "mattes"])
@given(seeds)
def test_mutual_information_is_never_negative(name, seed):
    assert value(METRICS.build(name), draw_pairs(seed)) <= ROUNDING


@given(seeds)
def test_unrelated_intensities_share_less_information(seed):
    pairs = draw_pairs(seed, 600)

    shuffled = replace(pairs, moving=np.random.default_rng((seed, 2)).permutation(pairs.moving))

    assert value(METRICS.build("mattes"), shuffled) > value(METRICS.build("mattes"), pairs)


@given(seeds, floats(-5.0, 5.0))
def test_mean_squares_of_a_constant_difference_is_its_square(seed, gap):
    pairs = draw_pairs(seed)

    got = value(METRICS.build("mean-squares"), replace(pairs, moving=pairs.fixed + gap))

    assert got == pytest.approx(gap * gap, abs=1e-9)
