import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from naive import carried as naive
from regframe.kernels import carried
from regframe.metrics.oriented_gradients import CarriedChannels

TURNED = np.array([[0.98137, -0.12171, 4.3371], [0.10193, 1.03313, -2.6177]])


@pytest.fixture
def planes():
    rng = np.random.default_rng(3)
    fixed, moving = (rng.normal(size=(*shape, 4)).astype(np.float32) for shape in ((41, 57), (52, 63)))
    for one in (fixed, moving):
        one[..., 3] = np.abs(one[..., 3])
        one[:6, :, 3] = 0.0
    return fixed, moving


def test_value_and_slope_agree_with_the_naive_ones(planes):
    value, slope = CarriedChannels(*planes).value_and_slope(TURNED)

    expected, by_map = naive.value_and_slope(*planes, TURNED)
    assert value == pytest.approx(expected, rel=1e-4)
    assert CarriedChannels(*planes).value(TURNED) == value
    np.testing.assert_allclose(slope, by_map, rtol=1e-3, atol=1e-4 * np.abs(by_map).max())


def test_nothing_in_common_is_infinite(planes):
    far = np.array([[1.0, 0.0, 900.0], [0.0, 1.0, 0.0]])

    value, slope = CarriedChannels(*planes).value_and_slope(far)

    assert value == np.inf
    assert not slope.any()


@given(by=arrays(float, (2, 3), elements=st.floats(-60.0, 60.0) | st.just(1.0) | st.just(math.nan)))
def test_a_run_holds_all_columns_that_lie_within_the_array_and_no_other(by):
    row, count, shape = 3, 20, (24, 31)
    places = by[:, 0] * row + by[:, 1] * np.arange(count)[:, None] + by[:, 2]

    first, last, way = carried._way(by, row, count, shape)

    deep = (places >= 2 * carried.NEAR) & (places < np.array(shape) - 1 - 2 * carried.NEAR)
    assert set(np.flatnonzero(deep.all(axis=1))) <= set(range(first, last))
    met = (np.array(way[:2]) + np.arange(max(last - first, 0))[:, None] * np.array(way[2:])) / carried.WHOLE
    assert ((met >= 0) & (met < np.array(shape) - 1)).all()
    np.testing.assert_allclose(met, places[first:last], atol=1e-7)


@pytest.mark.parametrize("no_map", [np.nan, np.inf, 1e300])
def test_what_is_no_map_meets_nothing(planes, no_map):
    assert CarriedChannels(*planes).value(np.full((2, 3), no_map)) == np.inf


@pytest.mark.parametrize("threads", [1, 2])
def test_bits_do_not_depend_on_threads(planes, threads, monkeypatch):
    monkeypatch.setenv("REGFRAME_THREADS", "3")
    expected = CarriedChannels(*planes).value_and_slope(TURNED)

    monkeypatch.setenv("REGFRAME_THREADS", str(threads))

    value, slope = CarriedChannels(*planes).value_and_slope(TURNED)
    assert value == expected[0]
    np.testing.assert_array_equal(slope, expected[1])


def test_turned_channels_agree_with_the_naive_ones(planes):
    angle = 0.4
    matrix = np.array([[np.cos(angle), np.sin(angle), 3.0], [-np.sin(angle), np.cos(angle), 9.0]])

    found = carried.turned(carried.about_means(planes[1]), matrix, (38, 44), angle)

    np.testing.assert_allclose(found[:, 0], naive.turned(planes[1], matrix, (38, 44), angle), atol=2e-5)
