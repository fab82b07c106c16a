"""The warp beside its formula, point by point, power by power."""

from itertools import product

import numpy as np
import pytest

from regframe import Frame, Grid
from regframe_polynomial import Polynomial

# Legendre's polynomials as books print them; the transform gets them from numpy's recurrence.
LEGENDRE = (
    lambda _: 1.0,
    lambda x: x,
    lambda x: (3 * x**2 - 1) / 2,
    lambda x: (5 * x**3 - 3 * x) / 2,
    lambda x: (35 * x**4 - 30 * x**2 + 3) / 8,
)
GRIDS = (
    Grid((30, 41), (0.5, 2.0), (3.0, -4.0), ((0.0, -1.0), (1.0, 0.0))),
    Grid(
        (9, 12, 15), (1.0, 1.5, 0.7), (3.0, -4.0, 11.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    ),
)


def slowly(params: dict[str, float], point, grid: Grid):
    """Where a point goes: each parameter times a product of polynomials, one an axis, along its direction."""
    size = np.array(grid.shape[::-1]) - 1
    place = 2 * grid.indices(point[None])[0, ::-1] / size - 1
    end = point.copy()
    for (direction, word), value in ((split(name), value) for name, value in params.items()):
        shares = [LEGENDRE[word.count(axis)](place["xyz".index(axis)]) for axis in "xyz"[: grid.dim]]
        end["xyz".index(direction)] += value * np.prod(shares)
    return end


def split(name: str) -> tuple[str, str]:
    """x[xxy] is P2(x) P1(y) along x."""
    return name[0], name[2:-1]


@pytest.mark.parametrize(("grid", "degree"), list(product(GRIDS, (2, 3, 4))))
def test_map_is_that_of_its_slow_twin(grid, degree):
    warp, frame, rng = Polynomial(degree=degree), Frame.about_centre(grid), np.random.default_rng(degree)
    names = warp.names(frame)
    params = rng.normal(size=len(names))
    points = grid.points(rng.uniform(0, np.array(grid.shape) - 1, (20, grid.dim)))

    ends = warp.map(params, points, frame)

    wanted = [slowly(dict(zip(names, params, strict=True)), point, grid) for point in points]
    np.testing.assert_allclose(ends, wanted, atol=1e-11)


@pytest.mark.parametrize("grid", GRIDS)
def test_parameter_gradient_is_that_of_its_slow_twin(grid):
    warp, frame, rng = Polynomial(), Frame.about_centre(grid), np.random.default_rng(7)
    names = warp.names(frame)
    points = grid.points(rng.uniform(0, np.array(grid.shape) - 1, (20, grid.dim)))
    forces = rng.normal(size=points.shape)

    gradient = warp.parameter_gradient(np.zeros(len(names)), points, forces, frame)

    # The map is linear in its parameters: each one's effect is the motion that it makes when it is 1.
    effects = [[slowly({name: 1.0}, point, grid) - point for point in points] for name in names]
    np.testing.assert_allclose(gradient, [(forces * each).sum() for each in effects], atol=1e-11)
