"""Joint histograms by fours, against windows put sample by sample."""

import numpy as np
import pytest

from naive import mattes
from regframe.kernels import parzen

BINS = 12
RANGE = (-1.0, 3.0)


def histogram(fixed, moving, weight, blocks=3):
    """Joint probability by the kernels."""
    width = (RANGE[1] - RANGE[0]) / (BINS - 4)
    row = np.clip(np.trunc(fixed / width - (RANGE[0] / width - 2)), 2, BINS - 3).astype(np.int32)
    axis = np.array([*RANGE, 1 / width, RANGE[0] / width - 2])
    partial, joint = np.full((blocks, BINS * BINS, 4), 7.0), np.zeros((BINS, BINS))
    parzen.moments(0, blocks, moving, weight, BINS * row, axis, BINS, partial)
    parzen.histogram(partial, BINS, joint)
    return joint / joint.sum()


@pytest.mark.parametrize("count", [1, 3, 4, 63, 64, 65, 1003])
def test_every_sample_is_counted_once(count):
    generator = np.random.default_rng(count)
    fixed, moving = generator.uniform(*RANGE, (2, count))
    weight = generator.uniform(0.5, 1.0, count)

    joint = histogram(fixed, moving, weight)

    expected = mattes.joint(fixed, moving, weight, RANGE, RANGE, BINS)
    assert np.abs(joint - expected).max() < 1e-14  # sums of rounding errors


def test_what_is_beyond_the_range_or_weighs_nothing_does_not_count():
    generator = np.random.default_rng(5)
    fixed, moving = generator.uniform(*RANGE, (2, 203))
    weight = np.ones(203)
    kept = np.ones(203, bool)
    kept[::3] = False
    moving[::6], moving[3::12], weight[9::12] = 1e9, np.nan, 0.0

    joint = histogram(fixed, moving, weight, blocks=1)

    assert np.abs(joint - histogram(fixed[kept], moving[kept], weight[kept], blocks=1)).max() < 1e-14


def test_information_is_that_of_the_equation():
    generator = np.random.default_rng(6)
    fixed, moving = generator.uniform(*RANGE, (2, 200))
    weight = np.ones(200)

    information = parzen.information(histogram(fixed, moving, weight))

    expected = -mattes.value(fixed, moving, weight, RANGE, RANGE, BINS)
    assert information == pytest.approx(expected, rel=1e-12)


def test_nothing_shared_has_no_information():
    assert parzen.information(np.zeros((BINS, BINS))) == -np.inf
