"""Grids, maps and parameters for hypothesis to draw.

Sizes are hypothesis's choice; continuous numbers come from a seed of its choice, which is much faster than
drawing each of them and loses little, since no law here depends on round numbers.
"""

import numpy as np
from hypothesis import strategies as st

from regframe.geometry import AffineMap, Frame, Grid


def floats(low, high):
    return st.floats(low, high, allow_nan=False, allow_infinity=False, width=64)


dimensions = st.sampled_from([2, 3])
seeds = st.integers(0, 2**32 - 1)


def rotation(dim, angles):
    """A rotation made of turns in the planes xy, xz and yz."""
    whole = np.eye(dim)
    planes = [(0, 1), (0, 2), (1, 2)][: 1 if dim == 2 else 3]
    for (a, b), angle in zip(planes, angles, strict=False):
        turn = np.eye(dim)
        turn[[a, a, b, b], [a, b, a, b]] = [np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)]
        whole = whole @ turn
    return whole


@st.composite
def grids(draw, dim=None):
    """A grid of any size, spacing, origin and direction."""
    dim = draw(dimensions) if dim is None else dim
    shape = draw(st.tuples(*[st.integers(1, 40)] * dim))
    rng = np.random.default_rng(draw(seeds))
    spacing = np.exp(rng.uniform(np.log(0.05), np.log(20.0), dim))
    direction = np.eye(dim) if rng.random() < 0.2 else rotation(dim, rng.uniform(-3.1, 3.1, 3))
    origin = rng.uniform(-500.0, 500.0, dim)
    rows = tuple(tuple(map(float, row)) for row in direction)
    return Grid(shape, tuple(map(float, spacing)), tuple(map(float, origin)), rows)


@st.composite
def frames(draw, dim=None):
    """A grid and a centre anywhere near it."""
    grid = draw(grids(dim))
    return Frame(grid, grid.centre + np.random.default_rng(draw(seeds)).uniform(-50.0, 50.0, grid.dim))


@st.composite
def affine_maps(draw, dim, *, mirrors=True):
    """A map that is far from singular: axes turned, each stretched by 0.3 to 3, and turned again.

    Without mirrors the turns are small, so that every family has a member near it.
    """
    rng = np.random.default_rng(draw(seeds))
    reach = 3.1 if mirrors else 0.6
    left, right = (rotation(dim, rng.uniform(-reach, reach, 3)) for _ in range(2))
    stretch = rng.uniform(0.3, 3.0, dim) * (rng.choice([-1.0, 1.0], dim) if mirrors else 1.0)
    return AffineMap(left @ np.diag(stretch) @ right, rng.uniform(-100.0, 100.0, dim))
