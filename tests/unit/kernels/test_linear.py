"""The vectorised linear interpolation of grids, against the one that goes sample by sample."""

import numpy as np
import pytest

from regframe.kernels import linear

WIDTHS = (1, 2, 3, 5, 63, 64, 66, 130)


@pytest.mark.parametrize("depth", [1, 5])
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("whole_steps", [False, True])
def test_grids_have_the_bits_of_single_samples(depth, width, whole_steps):
    generator = np.random.default_rng(width + depth)
    for _ in range(8):
        shape = (depth, generator.integers(1, 20), generator.integers(1, 100))
        grid = np.array((depth, 7, width), np.int64)
        volume, matrix = generator.normal(size=shape), moved(generator, depth)
        if whole_steps:  # corners and the border of the outer half pixel fall on samples
            matrix = np.round(2 * matrix) / 2
        single, many = (np.full((2, grid.prod()), 7.0) for _ in range(2))

        linear.resample(0, 7 * depth, volume, 1, grid, np.empty((0, 3)), matrix, *single)
        linear.resample_grid(0, 7 * depth, volume, grid, matrix, *many)

        assert np.array_equal(many, single)


def moved(generator, depth):
    """A map near the identity, (3, 4), array order; within the plane where there is one slice."""
    matrix, first = np.eye(3, 4), 0 if depth > 1 else 1
    matrix[first:, first:3] += generator.normal(scale=0.1, size=(3 - first, 3 - first))
    matrix[first:, 3] = generator.normal(scale=3.0, size=3 - first)
    return matrix
