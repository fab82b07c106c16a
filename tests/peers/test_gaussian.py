"""The recursive Gaussian against SimpleITK's: identical bits."""

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.kernels.gaussian import coefficients, filter_axis, gradient, smooth

GRIDS = [
    ((41, 57), (1.0, 1.0)),
    ((41, 57), (0.7, 1.3)),
    ((4, 5), (1.0, 1.0)),
    ((9, 14, 19), (1.0, 0.8, 2.2)),
]
TURN = np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])


def image(shape, spacing, dtype=np.float32):
    values = (100.0 * np.random.default_rng(1).normal(size=shape)).astype(dtype)
    theirs = sitk.GetImageFromArray(values)
    theirs.SetSpacing(spacing)
    return values, theirs


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("sigma", [0.6, 2.0, 8.0])
@pytest.mark.parametrize(("shape", "spacing"), GRIDS)
def test_smooths_to_the_same_bits(shape, spacing, sigma, dtype):
    values, theirs = image(shape, spacing, dtype)

    smoothed = smooth(values, [sigma / s for s in spacing[::-1]])

    assert np.array_equal(smoothed, sitk.GetArrayFromImage(sitk.SmoothingRecursiveGaussian(theirs, sigma)))


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("direction", [0, 1, 2])
def test_derives_along_one_axis_to_the_same_bits(direction, order):
    values, theirs = image((9, 14, 19), (1.0, 0.8, 2.2))
    line = values.astype(np.float64)

    filter_axis(line, 2 - direction, coefficients(1.7 / (1.0, 0.8, 2.2)[direction], order))

    expected = sitk.RecursiveGaussian(theirs, 1.7, False, order, direction)
    assert np.array_equal(line.astype(np.float32), sitk.GetArrayFromImage(expected))


@pytest.mark.parametrize(("shape", "spacing"), GRIDS)
def test_has_the_same_gradient_image(shape, spacing):
    values, theirs = image(shape, spacing)

    slopes = gradient(values, max(spacing), spacing=spacing)

    expected = sitk.GetArrayFromImage(sitk.GradientRecursiveGaussian(theirs, max(spacing), True, False))
    assert np.array_equal(slopes, np.moveaxis(expected, -1, 0))


def test_turns_the_gradient_image_with_the_direction():
    values, theirs = image((41, 57), (0.7, 1.3))
    theirs.SetDirection(TURN.ravel())

    slopes = gradient(values, 1.3, spacing=(0.7, 1.3), direction=TURN)

    expected = sitk.GetArrayFromImage(sitk.GradientRecursiveGaussian(theirs, 1.3, True, True))
    # SimpleITK rounds the turned vector to float32; its metrics, and ours, do not.
    assert np.array_equal(slopes.astype(np.float32), np.moveaxis(expected, -1, 0))


def test_refuses_what_simpleitk_refuses():
    _, theirs = image((3, 9), (1.0, 1.0))

    with pytest.raises(RuntimeError):
        sitk.SmoothingRecursiveGaussian(theirs, 1.0)
