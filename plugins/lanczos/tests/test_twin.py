"""The interpolator beside its formula, point by point, tap by tap."""

from itertools import product
from math import floor, pi, sin

import numpy as np
import pytest

from regframe_lanczos import Lanczos


def window(x: float, radius: int) -> float:
    """sinc(x) sinc(x / radius) between -radius and radius, else 0."""
    if x == 0:
        return 1.0
    return radius * sin(pi * x) * sin(pi * x / radius) / (pi * x) ** 2 if abs(x) < radius else 0.0


def slowly(volume, place, radius: int) -> float:
    """The neighbours' weighted mean; beyond the image, its rim goes on."""
    near = [range(floor(at) + 1 - radius, floor(at) + radius + 1) for at in place]
    total = mass = 0.0
    for taps in product(*near):
        weight = np.prod([window(at - tap, radius) for at, tap in zip(place, taps, strict=True)])
        inside = tuple(min(max(tap, 0), n - 1) for tap, n in zip(taps, volume.shape, strict=True))
        total += weight * volume[inside]
        mass += weight
    return total / mass


@pytest.mark.parametrize(("shape", "radius"), [((11, 13), 1), ((11, 13), 3), ((11, 13), 8), ((5, 6, 7), 2)])
def test_sample_is_that_of_its_slow_twin(shape, radius):
    rng = np.random.default_rng(radius)
    volume = rng.normal(size=shape)
    places = rng.uniform(-0.5, np.array(shape) - 0.5, (40, len(shape)))

    values = Lanczos(radius=radius).sample(volume, places)

    np.testing.assert_allclose(values, [slowly(volume, place, radius) for place in places], atol=1e-12)


def test_samples_of_whole_indices_are_those_of_its_slow_twin():
    volume = np.random.default_rng(4).normal(size=(6, 7))
    places = np.array([[0.0, 0.0], [2.0, 3.5], [5.0, 6.0]])

    values = Lanczos().sample(volume, places)

    np.testing.assert_allclose(values, [slowly(volume, place, 3) for place in places], atol=1e-12)
