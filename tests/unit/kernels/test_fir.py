"""Short filters: against scipy, and their own adjoint."""

import numpy as np
import pytest
from scipy import ndimage

from regframe.kernels.fir import blur, gaussian_taps


@pytest.mark.parametrize("sigma", [0.4, 0.7, 1.0, 1.5, 6.0])
@pytest.mark.parametrize("shape", [(2, 5, 40), (3, 17, 2), (1, 300, 320)])
def test_equals_scipy_with_zeros_beyond_the_border(sigma, shape):
    stack = np.random.default_rng(1).normal(size=shape)
    half = gaussian_taps(sigma)

    found = blur(stack, half, 2)

    taps = np.concatenate([half[:0:-1], half])
    wanted = ndimage.correlate1d(
        ndimage.correlate1d(stack, taps, 2, mode="constant"), taps, 1, mode="constant"
    )
    np.testing.assert_allclose(found, wanted, atol=1e-13)


def test_filters_all_axes_of_volumes():
    volume = np.zeros((1, 9, 9, 9))
    volume[0, 4, 4, 4] = 1.0

    found = blur(volume, gaussian_taps(1.0), 3)[0]

    assert found.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(found, found.transpose(2, 0, 1), atol=1e-15)


def test_is_its_own_adjoint():
    rng = np.random.default_rng(2)
    one, other = rng.normal(size=(2, 1, 12, 15))
    taps = gaussian_taps(1.2)

    assert (blur(one, taps, 2) * other).sum() == pytest.approx((one * blur(other, taps, 2)).sum())
