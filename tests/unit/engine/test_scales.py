"""How far a step moves, as scales measure it."""

import numpy as np
import pytest

from regframe.engine.scales import motion
from regframe.geometry import Frame, Grid
from regframe.preset import Level, Stage

GRID = Grid((9, 11), (1.0, 1.0), (0.0, 0.0), ((1.0, 0.0), (0.0, 1.0)))


def elastic(scales):
    return Stage(
        transform={"type": "displacement-field", "total_variance": 0.5},
        interpolator="linear",
        metric="mattes",
        optimizer="gradient-descent",
        scales=scales,
        levels=(Level(),),
    )


def moved(scales, size):
    rng, frame = np.random.default_rng(1), Frame.about_centre(GRID)
    field, step = rng.normal(size=(2, 2 * GRID.size))
    return motion(elastic(scales), field, size * step, frame, (GRID, GRID))


@pytest.mark.parametrize("size", [1e-6, 10.0])
def test_leaves_out_what_smoothing_the_whole_field_moves(size):
    found = moved("shift", size)

    assert found == pytest.approx(size * moved("shift", 1.0), rel=1e-8)


def test_counts_it_as_itk_does_where_itk_is_asked_for():
    found = moved("physical-shift", 1e-6)

    assert found > 0.1
