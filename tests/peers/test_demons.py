"""Demons against SimpleITK: value, and the push on each point of a displacement field."""

import numpy as np
import pytest

from regframe.catalog import TRANSFORMS
from regframe.engine.setting import Setting
from regframe.geometry import Grid
from regframe.image import Image
from regframe.peer import probe
from regframe.peer.method import Part
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.objectives import objective


def images(shape, spacing):
    fixed = peer.textured(shape, 1)
    moving = fixed + 0.2 * peer.textured(shape, 2)
    grid = Grid.of_shape(shape)
    grid = Grid(shape, spacing, grid.origin, grid.direction)
    return Image(fixed, grid, name="fixed"), Image(moving, grid, name="moving")


CASES = {
    "plane": ((30, 34), (1.0, 1.0)),
    "oblong": ((30, 34), (0.5, 2.0)),
    "space": ((9, 11, 12), (1.0, 1.5, 2.0)),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("gradient", ["filtered", "central"])
@pytest.mark.parametrize("masked", [False, True])
def test_value_and_pushes(case, gradient, masked):
    fixed, moving = images(*CASES[case])
    shift = [0.7, -1.2, 0.4][: fixed.dim]
    if masked:
        places = sum(np.indices(fixed.grid.shape))
        fixed, moving = fixed.with_mask(places > 9), moving.with_mask(places > 12)
    warp = Warp(TRANSFORMS.build("translation"), np.array(shift), peer.frame(fixed))
    ours = objective(
        fixed, moving, warp, "linear", metric={"type": "demons", "threshold": 4.0}, gradient=gradient
    )

    pairs = ours.pairs(warp.params)
    value, forces = ours.stage.metric.value(pairs), ours.forces(pairs)

    part = Part(ours.stage, ours.stage.levels, 1, Setting(fixed.grid))
    expected, pushes = probe.pushed(part, fixed, moving, warp)
    assert value == pytest.approx(expected, rel=1e-12)
    # Their push is the difference of two positions near 1, a share of 1e-15 of which is lost.
    np.testing.assert_allclose(forces, pushes, rtol=0, atol=1e-11 * np.abs(pushes).max())
    assert forces.any(axis=1).sum() > len(forces) / 4
