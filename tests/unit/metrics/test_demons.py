"""The demons: their pushes by hand, and a run that follows them."""

import numpy as np
import pytest

from regframe.engine.run import register
from regframe.metrics.base import Pairs
from regframe.metrics.demons import Demons
from regframe.testing.phantoms import smooth_pair


def pairs(difference, weight):
    moving = np.zeros_like(difference)
    return Pairs(difference, moving, weight, (-9.0, 9.0), (-9.0, 9.0))


def test_pushes_of_three_samples():
    given = pairs(np.array([2.0, -1.0, 0.5]), np.array([4.0, 2.0, 0.0]))
    slopes = np.array([[3.0, 0.0], [0.0, 2.0], [1.0, 1.0]])

    forces = Demons().forces(given, slopes, (1.0, 3.0))

    # K = (1 + 9) / 2 = 5: the first is - 2 * 3 / (4 / 5 + 9), the second has half the weight of the first.
    expected = [[-6.0 / 9.8, 0.0], [0.0, 0.5 * 2.0 / 4.2], [0.0, 0.0]]
    np.testing.assert_allclose(forces, expected, rtol=1e-14)


def test_small_differences_and_flat_places_push_nothing():
    given = pairs(np.array([0.9, 1.0, 1e-6]), np.ones(3))
    slopes = np.array([[1.0, 0.0], [1.0, 0.0], [0.0, 0.0]])

    pushed = Demons(threshold=1.0).forces(given, slopes, (1.0, 1.0)).any(axis=1)
    flat = Demons(threshold=0.0).forces(given, slopes, (1.0, 1.0)).any(axis=1)

    assert pushed.tolist() == [False, True, False]
    assert flat.tolist() == [True, True, False]


@pytest.mark.parametrize("gradient", ["exact", "filtered", "central"])
def test_descent_along_the_pushes_finds_a_shift(gradient):
    phantom = smooth_pair("mono", (40, 44), seed=1)
    moving = phantom.moving.with_values(np.roll(phantom.moving.values, (1, -2), axis=(0, 1)))
    stage = {
        "start": "identity",
        "transform": "translation",
        "interpolator": "linear",
        "metric": "demons",
        "optimizer": {"type": "regular-step-gradient-descent", "learning_rate": 1.0},
        "gradient": gradient,
        "levels": [{"iterations": 60}],
    }

    result = register({"stages": [stage]}, phantom.fixed, moving)

    np.testing.assert_allclose(result.warp.params, [-2.0, 1.0], atol=0.1)
