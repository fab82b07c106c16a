"""The first two floors of the cross-check, for every family of maps and both float types."""

import numpy as np
import pytest

from regframe.catalog import TRANSFORMS
from regframe.engine.setting import Setting
from regframe.geometry import Grid
from regframe.peer import components, pairs
from regframe.peer.bench import Bench
from regframe.preset import Stage
from regframe.transforms.warp import Warp
from support import sitk as peer

PLANE = Grid((30, 36), (0.9, 1.2), (3.0, -4.0), ((0.8, -0.6), (0.6, 0.8)))
SPACE = Grid((12, 14, 16), (1.0, 1.1, 1.4), (3.0, 0.0, -5.0), tuple(map(tuple, np.eye(3))))
WITHOUT_TWIN = {"projective", "projective-radial"}
"""ITK has neither homographies nor lenses."""
CASES = [
    (name, grid)
    for name in TRANSFORMS.names()
    for grid in (PLANE, SPACE)
    if TRANSFORMS.origin(name) == "regframe" and grid.dim in TRANSFORMS[name].dimensions
    if name not in WITHOUT_TWIN
]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(
    ("name", "grid"),
    [pytest.param(name, grid, marks=[pytest.mark.slow] * (grid.dim == 3)) for name, grid in CASES],
)
def test_parts_and_pairs_agree(name, grid, dtype):
    fixed, moving = peer.pair(grid.shape, dtype, grid=grid)
    stage = Stage(
        transform=TRANSFORMS.build({"type": name, **({"mesh": [2] * grid.dim} if name == "bspline" else {})}),
        interpolator="linear",
        metric="mattes",
        optimizer="one-plus-one",
        levels=[{"shrink": 1, "smooth": 0.7}],
    )
    frame = peer.frame(fixed)
    params = stage.transform.identity(frame)
    off = np.random.default_rng(6).normal(size=len(params)) / stage.transform.shift(params, frame)
    bench = Bench(
        stage, 1, fixed, moving, Warp(stage.transform, params + 0.7 * off, frame), Setting(fixed.grid)
    )

    lines = [*components.compare(bench, "")[0], *pairs.compare(bench, "")]

    assert [line for line in lines if line.verdict != "agrees"] == []
