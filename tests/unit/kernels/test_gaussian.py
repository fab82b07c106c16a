"""The recursive Gaussian: its slow twin, moments, borders, types, threads and errors."""

import numpy as np
import pytest

from naive import gaussian as naive
from regframe.errors import GeometryError
from regframe.kernels.gaussian import coefficients, filter_axis, gradient, smooth


def noise(shape: tuple[int, ...], seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=shape)


@pytest.mark.parametrize(("shape", "sigmas"), [((13, 17), (1.0, 2.5)), ((5, 9, 11), (0.7, 3.0, 1.2))])
def test_equals_its_slow_twin(shape, sigmas):
    values = noise(shape)

    smoothed = smooth(values, sigmas)

    # the last bit of a line may round to the neighbouring float32
    np.testing.assert_allclose(smoothed, naive.smooth(values, sigmas), rtol=0, atol=1.2e-7 * 3)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("sigma", [0.6, 2.0, 9.0])
def test_weights_equal_the_slow_twin(order, sigma):
    forward, feedback = naive.weights(sigma, order)

    weights = coefficients(sigma, order)

    np.testing.assert_allclose(weights[0], feedback, rtol=1e-13)
    # weights of order 2 come from differences of nearly equal numbers
    np.testing.assert_allclose(weights[1], forward, rtol=1e-9, atol=1e-13)


@pytest.mark.parametrize(("order", "derivative"), [(0, 1.0), (1, 1.0), (2, 2.0)])
def test_has_the_true_derivative_of_a_power(order, derivative):
    x = np.arange(-100.0, 101.0)
    line = (x**order).reshape(1, -1)

    filter_axis(line, 1, coefficients(3.0, order))

    assert line[0, 100] == pytest.approx(derivative, rel=1e-6)  # float32


@pytest.mark.parametrize("order", [0, 1, 2])
def test_filters_one_axis_as_the_slow_twin(order):
    line = noise((1, 30))
    expected = naive.filter_line(line[0], 1.7, order)

    filter_axis(line, 1, coefficients(1.7, order))

    np.testing.assert_allclose(line[0], expected, atol=1.2e-7)  # float32


def test_leaves_a_constant_image_constant():
    values = np.full((12, 15), 7.25, dtype=np.float32)

    smoothed = smooth(values, (2.0, 3.0))

    np.testing.assert_allclose(smoothed, 7.25, rtol=2e-7)  # one float32 rounding an axis


def test_rounds_float64_images_to_float32():
    smoothed = smooth(noise((9, 10)), (1.0, 1.0))

    assert smoothed.dtype == np.float64
    assert np.array_equal(smoothed, smoothed.astype(np.float32))


def test_keeps_the_type_of_a_float32_image():
    values = noise((9, 10)).astype(np.float32)

    smoothed = smooth(values, (1.0, 1.0))

    assert smoothed.dtype == np.float32
    assert np.array_equal(smoothed, smooth(values.astype(np.float64), (1.0, 1.0)))


def test_leaves_its_input_alone():
    values = noise((9, 10))
    before = values.copy()

    smooth(values, (1.0, 1.0))
    gradient(values, 1.0, spacing=(1.0, 1.0))

    assert np.array_equal(values, before)


def test_sigma_zero_leaves_an_axis_alone():
    values = noise((3, 20)).astype(np.float32)

    smoothed = smooth(values, (0.0, 2.0))

    assert np.array_equal(smoothed[1], smooth(values[1:2].repeat(5, axis=0), (0.0, 2.0))[0])


def test_sigma_zero_on_all_axes_returns_the_values():
    values = noise((6, 7))

    assert np.array_equal(smooth(values, (0.0, 0.0)), values)


def test_accepts_strided_images():
    values = noise((20, 24))

    assert np.array_equal(
        smooth(values[::2, ::3].T, (1.0, 2.0)), smooth(values[::2, ::3].T.copy(), (1.0, 2.0))
    )


@pytest.mark.parametrize("shape", [(4, 4), (4, 5, 7), (9, 8), (31, 33)])
def test_does_not_depend_on_the_number_of_threads(shape, monkeypatch):
    values = noise(shape)
    results = []

    for count in (1, 2, 4):
        monkeypatch.setenv("REGFRAME_THREADS", str(count))
        results.append(smooth(values, (1.5,) * len(shape)).tobytes())

    assert len(set(results)) == 1


@pytest.mark.parametrize("shape", [(3, 20), (20, 3), (8, 8, 1)])
def test_refuses_an_axis_too_short(shape):
    with pytest.raises(GeometryError, match="at least 4 pixels") as caught:
        smooth(np.ones(shape), (1.0,) * len(shape))

    assert str(shape) in str(caught.value)


def test_the_gradient_refuses_an_axis_too_short():
    with pytest.raises(GeometryError, match="at least 4 pixels"):
        gradient(np.ones((3, 9)), 1.0, spacing=(1.0, 1.0))


def test_the_gradient_of_a_ramp_is_its_slope_times_sigma():
    y, x = np.mgrid[:40, :50].astype(np.float64)
    ramp = 3.0 * (0.5 * x) + 2.0 * (2.0 * y)  # 3 per mm along x, 2 per mm along y

    slopes = gradient(ramp, 2.0, spacing=(0.5, 2.0))

    assert slopes.shape == (2, 40, 50)
    np.testing.assert_allclose(slopes[0][:, 25], 6.0, rtol=1e-3)  # the fit's own error
    np.testing.assert_allclose(slopes[1][20], 4.0, rtol=1e-3)


def test_the_gradient_turns_with_the_image():
    values = noise((10, 12))
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])

    plain, turned = (
        gradient(values, 1.0, spacing=(1.0, 1.0)),
        gradient(values, 1.0, spacing=(1.0, 1.0), direction=quarter),
    )

    assert np.array_equal(turned[0], -plain[1])
    assert np.array_equal(turned[1], plain[0])
