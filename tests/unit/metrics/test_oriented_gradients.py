"""Oriented gradients: against their slow twin, and what they may not notice."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import ndimage

from naive import oriented_gradients as naive
from regframe.kernels import orientation
from regframe.kernels.orientation import Settings
from regframe.metrics.base import Pairs
from regframe.metrics.oriented_gradients import OrientedGradients

OPTIONS = {"inner": 0.8, "outer": 1.2, "offset": 0.3, "magnitude": 0.7}


def pairs(shape=(40, 52), *, seed=1, holes=0.0):
    rng = np.random.default_rng(seed)
    fixed, moving = (ndimage.gaussian_filter(rng.normal(size=shape), 1.5) for _ in range(2))
    weight = (rng.random(shape) >= holes).astype(float)
    ranges = (fixed.min(), fixed.max()), (moving.min(), moving.max())
    return Pairs(fixed.ravel(), moving.ravel(), weight.ravel(), *ranges, shape)


@pytest.mark.parametrize("holes", [0.0, 0.05, 0.3])
def test_equals_the_slow_twin(holes):
    given = pairs(holes=holes)

    value = OrientedGradients(**OPTIONS).value(given)

    planes = (part.reshape(given.shape) for part in (given.fixed, given.moving, given.weight))
    # Gradients below 1e-4 of the range lose their direction here and not in the twin.
    assert value == pytest.approx(naive.value(*planes, **OPTIONS), abs=1e-4)


def test_an_image_matches_its_own_negative_fully():
    given = pairs(holes=0.05)

    value = OrientedGradients().value(
        replace(given, moving=-2.0 * given.fixed + 7.0, moving_range=(-3.0, 9.0))
    )

    # The two ranges make slightly different gradients count as flat.
    assert value == pytest.approx(-1.0, abs=1e-3)


def test_turning_both_images_a_quarter_changes_nothing():
    given = pairs((40, 40), holes=0.1)
    turned = replace(
        given,
        **{
            name: np.rot90(getattr(given, name).reshape(given.shape)).ravel().copy()
            for name in ("fixed", "moving", "weight")
        },
    )

    metric = OrientedGradients()

    assert metric.value(turned) == pytest.approx(metric.value(given), rel=1e-9)


def test_channels_turn_twice_as_far_as_the_image():
    y, x = np.mgrid[:32, :32].astype(float)
    settings = Settings(0.7, 1.0, 0.1, 1.0, 1e-9)

    for angle in np.deg2rad([0.0, 20.0, 75.0, 160.0]):
        wave = np.sin(0.5 * (x * np.cos(angle) + y * np.sin(angle)))
        made = orientation.features(wave[None], np.ones((1, 32, 32)), settings)
        direction = np.arctan2(made.units[2, 0, 16, 16], made.units[1, 0, 16, 16])

        # Central differences see diagonal waves a little flatter.
        assert np.angle(np.exp(1j * (direction - 2 * angle))) == pytest.approx(0.0, abs=0.03)


def test_volumes_have_slopes_too():
    given = pairs((9, 10, 11), holes=0.1)
    metric = OrientedGradients(inner=0.6, outer=0.8)
    direction = np.random.default_rng(3).normal(size=len(given.moving)) * (given.weight > 0)
    step = 1e-6

    slope = float(metric.derivative(given) @ direction)

    ahead, behind = (
        metric.value(replace(given, moving=given.moving + side * step * direction)) for side in (1, -1)
    )
    assert slope == pytest.approx((ahead - behind) / (2 * step), rel=1e-5)


def test_all_translations_at_once_agree_with_the_value():
    given = pairs((40, 52), seed=4)
    metric = OrientedGradients(inner=0.7, outer=1.0)
    moving = np.roll(given.fixed.reshape(given.shape), (3, -5), axis=(0, 1))
    weight = np.ones(given.shape)

    values, shared = metric.translations(given, (96, 128))(moving, weight)

    assert np.unravel_index(np.argmin(values), values.shape) == (3, 128 - 5)
    # The lattice's correlation trusts borders that the pairs of one translation do not.
    assert values.min() < -0.9
    assert shared[0, 0] == pytest.approx(40 * 52, rel=0.25)


def test_turned_channels_score_as_those_of_a_turned_image():
    given = pairs((40, 52), seed=4)
    moving, weight = np.roll(given.fixed.reshape(given.shape), (3, -5), axis=(0, 1)), np.ones(given.shape)
    translations = OrientedGradients(inner=0.7, outer=1.0).translations(given, (96, 128))
    # By half a turn nothing is lost between points, and directions without sign stay.
    half = np.array([[-1.0, 0.0, 39.0], [0.0, -1.0, 51.0]])

    values, _ = translations.upright(moving, weight)(half, given.shape, np.pi)
    expected, _ = translations(np.ascontiguousarray(moving[::-1, ::-1]), weight)

    np.testing.assert_allclose(values[:8, :8], expected[:8, :8], atol=0.03)
