"""Interpolated values against SimpleITK, the outer half pixel included."""

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.catalog import INTERPOLATORS
from regframe.interpolators.base import Samples
from support import sitk as peer
from support.objectives import SINCS, SPLINES

EXACT = ("nearest", "linear", "bspline3", "label-gaussian")
CONFIGS = SPLINES | SINCS


def places(shape: tuple[int, ...], seed: int) -> np.ndarray:
    """Random positions, half-way ties and borders, array order, inside."""
    rng = np.random.default_rng(seed)
    free = rng.uniform(-0.5, np.array(shape) - 0.5000001, (300, len(shape)))
    halves = np.round(rng.uniform(0, np.array(shape) - 1.5, (60, len(shape)))) + 0.5
    whole = np.round(rng.uniform(0, np.array(shape) - 1.0, (60, len(shape))))
    edge = np.array([np.full(len(shape), -0.5), np.array(shape) - 0.5000001])
    return np.concatenate([free, halves, whole, edge])


@pytest.mark.parametrize("interpolator", ["nearest", "linear", "gaussian", "label-gaussian", *CONFIGS])
@pytest.mark.parametrize("shape", [(17, 23), (9, 11, 8), (5, 40)])
def test_values_at_any_position(interpolator, shape):
    values = peer.textured(shape, 4, levels=256)
    if interpolator == "label-gaussian":
        values = np.round(values / 40.0)
    theirs = sitk.GetImageFromArray(values)
    ours = INTERPOLATORS.build(CONFIGS.get(interpolator, interpolator))
    at = places(shape, 7)

    found, weight = ours.resample(ours.prepare(values), Samples(shape, at), None)

    expected = [
        theirs.EvaluateAtContinuousIndex(one[::-1].tolist(), peer.INTERPOLATORS[interpolator]) for one in at
    ]
    assert weight.all()
    if interpolator in EXACT:
        np.testing.assert_array_equal(found, expected)
    else:
        # ITK's error function is an approximation with errors of some 1e-9.
        bound = 1e-7 if interpolator == "gaussian" else 1e-12
        np.testing.assert_allclose(found, expected, rtol=0, atol=bound * 255)


@pytest.mark.parametrize("interpolator", ["linear", "bspline3", "lanczos-sinc"])
def test_resampled_images(interpolator):
    values = peer.textured((40, 52), 4)
    theirs, turned = sitk.GetImageFromArray(values), sitk.AffineTransform(2)
    turned.SetMatrix([1.03, 0.06, -0.04, 0.95])
    turned.SetTranslation([2.5, -3.25])
    ours = INTERPOLATORS.build(CONFIGS.get(interpolator, interpolator))
    y, x = np.indices(values.shape).reshape(2, -1).astype(float)
    at = np.stack([-0.04 * x + 0.95 * y - 3.25, 1.03 * x + 0.06 * y + 2.5], axis=1)

    found, _ = ours.resample(ours.prepare(values), Samples(values.shape, at), None)

    expected = sitk.GetArrayFromImage(sitk.Resample(theirs, turned, peer.INTERPOLATORS[interpolator], 0.0))
    np.testing.assert_allclose(found, expected.ravel(), rtol=0, atol=1e-12 * 255)
