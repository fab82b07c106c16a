"""Interpolation kernels against their slow twins, borders included."""

import numpy as np
import pytest

from naive import interpolation as naive
from regframe.geometry import AffineMap
from regframe.interpolators.base import Interpolator, Samples
from regframe.interpolators.bspline import BSpline
from regframe.interpolators.linear import Linear
from regframe.interpolators.volumes import kernel_matrix, resampled
from regframe.kernels import spline

SHAPES = [(9, 12), (6, 5, 7)]


def positions(shape):
    rng = np.random.default_rng(3)
    return rng.uniform(-0.5, np.array(shape) - 0.500001, (80, len(shape)))


@pytest.mark.parametrize("shape", SHAPES)
def test_linear_equals_the_slow_twin(shape):
    volume, at = np.random.default_rng(1).normal(size=shape), positions(shape)

    found = Linear().sample(volume, at)

    np.testing.assert_allclose(found, [naive.linear(volume, one) for one in at], atol=1e-13)


@pytest.mark.parametrize("shape", SHAPES)
def test_cubic_spline_equals_the_slow_twin(shape):
    volume, at = np.random.default_rng(1).normal(size=shape), positions(shape)
    coefficients = volume
    for axis in range(len(shape)):
        coefficients = np.apply_along_axis(naive.coefficients, axis, coefficients)

    found = BSpline().sample(BSpline().prepare(volume), at)

    # The recursive filter's sum is cut where its terms fall below 1e-10.
    np.testing.assert_allclose(found, [naive.spline(coefficients, one) for one in at], atol=1e-8)


@pytest.mark.parametrize("interpolator", [Linear(), BSpline()], ids=["linear", "bspline"])
@pytest.mark.parametrize("size", [(37, 41), (64, 130), (5, 200)])
def test_kernels_for_whole_planes_give_the_bits_of_the_general_ones(interpolator, size):
    volume = np.random.default_rng(1).normal(size=(40, 90))
    coefficients = interpolator.prepare(volume)
    turn = AffineMap(np.array([[1.03, 0.2], [-0.2, 0.97]]), np.array([-4.25, 3.5]))

    values, weights = interpolator.resample(coefficients, Samples(size), turn)

    whole = Samples(size, Samples(size).all_indices())
    expected, inside = interpolator.resample(coefficients, whole, turn)
    np.testing.assert_array_equal(values, expected)
    np.testing.assert_array_equal(weights, inside)


@pytest.mark.parametrize("shape", [(40, 90), (5, 3), (1, 30), (2, 2)])
def test_cubic_splines_in_the_plane_give_the_numbers_of_the_general_kernel(shape):
    rng = np.random.default_rng(1)
    coefficients, turn = (
        BSpline().prepare(rng.normal(size=shape)),
        AffineMap(np.eye(2) * 0.9, np.array([0.3, 0.1])),
    )
    samples = Samples(shape, rng.uniform(-1.5, np.array(shape) + 0.5, (500, 2)))
    forces = rng.normal(size=500)

    values, weights = BSpline().resample(coefficients, samples, turn)
    slopes = BSpline().gradient(coefficients, samples.all_indices())
    pulled = BSpline().pull_back(coefficients, samples, turn, forces * weights)

    general = coefficients[None]
    spatial = np.column_stack([np.zeros(500), samples.all_indices()])
    expected, inside = resampled(spline.resample, coefficients, 3, samples, turn)
    steep, partial = np.empty((500, 3)), np.zeros((1, 3, 4))
    spline.gradient(0, 500, general, 3, spatial, steep)
    matrix = kernel_matrix(turn, 2)
    spline.pull_back(0, 1, general, 3, np.ones(3, np.int64), spatial, matrix, forces * weights, partial)
    np.testing.assert_array_equal(values, expected)
    np.testing.assert_array_equal(weights, inside)
    np.testing.assert_allclose(slopes, steep[:, 1:], rtol=0, atol=1e-13 * np.abs(coefficients).max())
    np.testing.assert_allclose(pulled, partial[0, 1:, 1:], rtol=1e-10, atol=1e-11)


def test_pull_back_through_a_whole_volume_equals_its_default():
    volume, samples = np.random.default_rng(1).normal(size=(9, 12, 80)), Samples((10, 11, 75))
    turn = AffineMap(
        np.array([[1.1, 0.1, 0], [-0.1, 0.97, 0.2], [0.01, -0.2, 1.0]]), np.array([-1.3, 0.5, 2])
    )
    _, weights = Linear().resample(volume, samples, turn)
    forces = np.random.default_rng(2).normal(size=len(samples)) * weights

    pulled = Linear().pull_back(volume, samples, turn, forces)

    expected = Interpolator.pull_back(Linear(), volume, samples, turn, forces)
    np.testing.assert_allclose(pulled, expected, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("interpolator", [Linear(), BSpline()], ids=["linear", "bspline"])
def test_pull_back_equals_its_default(interpolator):
    volume = np.random.default_rng(1).normal(size=(40, 90))
    coefficients, samples = interpolator.prepare(volume), Samples((64, 70))
    turn = AffineMap(np.array([[1.03, 0.2], [-0.2, 0.97]]), np.array([-4.25, 3.5]))
    _, weights = interpolator.resample(coefficients, samples, turn)
    forces = np.random.default_rng(2).normal(size=len(samples)) * weights

    pulled = interpolator.pull_back(coefficients, samples, turn, forces)

    expected = Interpolator.pull_back(interpolator, coefficients, samples, turn, forces)
    np.testing.assert_allclose(pulled, expected, atol=1e-10 * np.abs(expected).max())
