"""The few lowest places of a table, against a search of the whole table."""

import numpy as np
import pytest

from naive.lowest import lowest as slow
from regframe.kernels.lowest import lowest

ALL = np.arange(12), np.arange(15)


def table(seed):
    rng = np.random.default_rng(seed)
    return rng.random((12, 15)).astype(np.float32), rng.random((12, 15)).astype(np.float32)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("apart", [0, 2, 4])
def test_equals_a_search_of_the_whole_table(seed, apart):
    scored, shared = table(seed)
    within = np.array([0, 1, 2, 9, 10, 11]), np.array([0, 3, 4, 5, 6, 13, 14])

    found = lowest(scored, shared, within, 0.3, 5, apart)

    assert [tuple(at) for at in found.tolist()] == slow(scored, shared, within, 0.3, 5, apart)


def test_neighbours_across_the_border_are_near():
    scored = np.ones((12, 15))
    scored[0, 0], scored[11, 14], scored[6, 7] = -3.0, -2.0, -1.0

    found = lowest(scored, np.ones_like(scored), ALL, 0.5, 2, 1)

    assert found.tolist() == [[0, 0], [6, 7]]


def test_nothing_is_taken_where_too_little_meets():
    scored, shared = table(1)

    assert lowest(scored, shared, ALL, 2.0, 3, 1).shape == (0, 2)
    assert lowest(np.full_like(scored, np.nan), shared, ALL, 0.0, 3, 1).shape == (0, 2)
