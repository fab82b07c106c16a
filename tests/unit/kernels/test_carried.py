import numpy as np
import pytest

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
