"""What moving, mirroring or scaling an image does to its interpolation: the same, and nothing else."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from properties.strategies import dimensions, floats, seeds

from regframe.catalog import INTERPOLATORS
from regframe.geometry import AffineMap
from regframe.interpolators.base import Samples

CONFIGS = [*INTERPOLATORS.names(), *({"type": "bspline", "order": order} for order in (1, 2, 5))]
every = pytest.mark.parametrize("config", CONFIGS, ids=str)
exact = pytest.mark.parametrize("config", [c for c in CONFIGS if INTERPOLATORS.build(c).exact], ids=str)
constant = pytest.mark.parametrize(
    "config", [c for c in CONFIGS if INTERPOLATORS.build(c).keeps_constants], ids=str
)
shapes = {2: (11, 13), 3: (6, 7, 8)}
ROUNDING = 1e-10  # of values in [0, 1], through a prefilter whose gain is below 50


def volume_of(dim, seed):
    return np.random.default_rng((seed, dim)).random(shapes[dim])


def places(shape, seed, count=25):
    """Inside and a little away from pixel edges and centres, where nearest neighbours change hands."""
    rng = np.random.default_rng((seed, 1))
    whole = np.stack([rng.integers(0, n - 1, count) for n in shape], axis=1)
    return whole + rng.choice([0.05, 0.55], whole.shape) + rng.uniform(0.0, 0.4, whole.shape)


def read(interpolator, volume, indices):
    return interpolator.sample(interpolator.prepare(volume), np.ascontiguousarray(indices))


@constant
@given(dimensions, seeds, floats(-3.0, 3.0), floats(-3.0, 3.0))
def test_follows_gain_and_offset_of_the_image(config, dim, seed, gain, offset):
    interpolator, volume = INTERPOLATORS.build(config), volume_of(dim, seed)
    indices = places(volume.shape, seed)

    got = read(interpolator, gain * volume + offset, indices)

    np.testing.assert_allclose(
        got, gain * read(interpolator, volume, indices) + offset, rtol=0, atol=10 * ROUNDING
    )


@every
@given(dimensions, seeds, st.integers(0, 2))
def test_mirrors_with_the_image(config, dim, seed, axis):
    interpolator, volume = INTERPOLATORS.build(config), volume_of(dim, seed)
    indices, axis = places(volume.shape, seed), axis % dim

    mirrored = indices.copy()
    mirrored[:, axis] = volume.shape[axis] - 1 - indices[:, axis]
    got = read(interpolator, np.ascontiguousarray(np.flip(volume, axis)), mirrored)

    np.testing.assert_allclose(got, read(interpolator, volume, indices), rtol=0, atol=ROUNDING)


@every
@given(dimensions, seeds)
def test_turns_with_the_image(config, dim, seed):
    """Swapping axes of the image and of the indices changes nothing."""
    interpolator, volume = INTERPOLATORS.build(config), volume_of(dim, seed)
    indices = places(volume.shape, seed)

    got = read(interpolator, np.ascontiguousarray(volume.T), indices[:, ::-1])

    np.testing.assert_allclose(got, read(interpolator, volume, indices), rtol=0, atol=ROUNDING)


@exact
@given(dimensions, seeds, st.integers(-2, 2))
def test_whole_steps_are_exact_shifts(config, dim, seed, step):
    interpolator, volume = INTERPOLATORS.build(config), volume_of(dim, seed)
    index_map = AffineMap(np.eye(dim), np.full(dim, float(step)))

    values, weights = interpolator.resample(interpolator.prepare(volume), Samples(volume.shape), index_map)

    places_now = Samples(volume.shape).all_indices() + step
    inside = np.all((places_now >= 0) & (places_now < np.array(volume.shape)), axis=1)
    rolled = np.roll(volume, -step, axis=tuple(range(dim))).ravel()
    assert np.array_equal(weights, inside)
    np.testing.assert_allclose(values, np.where(inside, rolled, 0.0), rtol=0, atol=ROUNDING)


@every
@given(dimensions, seeds)
def test_sparse_samples_are_those_of_the_grid(config, dim, seed):
    interpolator, volume = INTERPOLATORS.build(config), volume_of(dim, seed)
    rng = np.random.default_rng((seed, 2))
    index_map = AffineMap(np.eye(dim) + 0.1 * rng.standard_normal((dim, dim)), rng.uniform(-1, 1, dim))
    whole = Samples(volume.shape)
    picked = rng.choice(len(whole), 20, replace=False)
    coefficients = interpolator.prepare(volume)

    dense = interpolator.resample(coefficients, whole, index_map)
    sparse = interpolator.resample(
        coefficients, Samples(volume.shape, whole.all_indices()[picked]), index_map
    )

    for one, other in zip(dense, sparse, strict=True):
        np.testing.assert_allclose(other, one[picked], rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
@given(dimensions, seeds)
def test_splines_reproduce_polynomials_of_their_order(order, dim, seed):
    """Far from the mirrored borders a spline of order n passes through polynomials of degree n exactly."""
    size = 41 if dim == 2 else 33
    factors = np.random.default_rng((seed, 3)).uniform(-1, 1, order + 1)
    along = np.polyval(factors, np.linspace(-1, 1, size))
    volume = np.multiply.outer(np.ones((size,) * (dim - 1)), along) if dim == 2 else np.tile(along, (5, 5, 1))
    interpolator = INTERPOLATORS.build({"type": "bspline", "order": order})
    indices = np.full((15, dim), 2.3)
    indices[:, -1] = np.random.default_rng((seed, 4)).uniform(size / 2 - 2, size / 2 + 2, 15)

    got = read(interpolator, np.ascontiguousarray(volume), indices)

    wanted = np.polyval(factors, indices[:, -1] * 2 / (size - 1) - 1)
    # The slowest pole, -0.43, has fallen to 1e-6 sixteen pixels from the border.
    np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-4 if order > 3 else 1e-6)


@every
@given(seeds)
def test_pull_back_is_the_slope_of_resample_by_the_map(config, seed):
    """The number `forces . resample` changes with an entry of the map as `pull_back` says."""
    interpolator, volume = INTERPOLATORS.build(config), volume_of(2, seed)
    coefficients = interpolator.prepare(volume)
    indices = places(volume.shape, seed)
    samples = Samples(volume.shape, indices)
    still = AffineMap.identity(2)
    forces = np.random.default_rng((seed, 5)).standard_normal(len(indices))

    pulled = interpolator.pull_back(coefficients, samples, still, forces)

    step = 1e-6
    for row in range(2):
        for column in range(3):
            change = np.zeros((2, 3))
            change[row, column] = step
            ahead, behind = (
                forces
                @ interpolator.sample(
                    coefficients, indices + side * (indices @ change[:, :2].T + change[:, 2])
                )
                for side in (1, -1)
            )
            assert pulled[row, column] == pytest.approx((ahead - behind) / (2 * step), abs=1e-4)
