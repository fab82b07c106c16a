"""The optimizer beside a plain loop of the package, in coordinates where a unit is a pixel of motion."""

from itertools import islice

import numpy as np
import pytest
from cmaes import CMA

from regframe_cma_es import CmaEs

START = np.array([1.0, -2.0, 0.5])
GOAL = np.array([3.0, 1.0, -1.0])
WALK = 30


class Valley:
    """Lowest at the goal, bent, and steeper along some of the axes; `scales` are pixels a unit."""

    def __init__(self, scales):
        self.scales = np.array(scales)

    def values(self, batch):
        away = batch * self.scales - GOAL
        return (away**2 * [1.0, 3.0, 9.0]).sum(axis=1) + 0.5 * (away[:, 0] * away[:, 1]) ** 2


def slowly(optimizer, seed):
    """Best position, its value and the generation's spread, a generation each."""
    valley = Valley([1.0, 1.0, 1.0])
    best, lowest = START, float(valley.values(START[None])[0])
    reach = optimizer.reach
    bounds = None if reach is None else np.array([[at - reach, at + reach] for at in START])
    cloud = CMA(START.copy(), optimizer.sigma, bounds, seed=seed, population_size=optimizer.population)
    for _ in range(WALK):
        told = []
        for _ in range(cloud.population_size):
            place = cloud.ask()
            told.append((place, float(valley.values(place[None])[0])))
        for place, value in told:
            if value < lowest:
                best, lowest = place, value
        cloud.tell(told)
        yield best, lowest, max(np.std([place[axis] for place, _ in told]) for axis in range(3))


@pytest.mark.parametrize("scale", [1.0, 4.0])
@pytest.mark.parametrize("optimizer", [CmaEs(), CmaEs(reach=2.5, population=12), CmaEs(sigma=0.5)])
def test_the_walk_is_that_of_its_slow_twin(optimizer, scale):
    deviate = optimizer.normals(9).standard_normal(1)
    seed = int(deviate.view(np.uint64)[0] % 2**32)
    valley = Valley([scale] * 3)

    walk = islice(optimizer.steps(valley, START / scale, optimizer.normals(9)), WALK)

    for step, (best, lowest, spread) in zip(walk, slowly(optimizer, seed), strict=True):
        # The covariances differ by a factor, and their eigenvectors in the last digits.
        np.testing.assert_allclose(step.params * scale, best, atol=1e-6)
        assert step.value == pytest.approx(lowest, abs=1e-6)
        assert step.size == pytest.approx(spread, abs=1e-6)


def test_the_first_generation_spreads_as_far_along_every_coordinate_in_pixels():
    scales = np.array([4.0, 0.25, 64.0])
    met = []

    class Watched(Valley):
        def values(self, batch):
            met.append(batch * self.scales)
            return super().values(batch)

    optimizer = CmaEs(sigma=3.0, population=4000)
    next(optimizer.steps(Watched(scales), START / scales, optimizer.normals(9)))

    assert met[-1].std(axis=0) == pytest.approx([3.0, 3.0, 3.0], rel=0.05)
    assert met[-1].mean(axis=0) == pytest.approx(START, abs=0.2)
