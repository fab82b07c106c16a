"""How a stage takes up the map of the one before."""

import numpy as np
import pytest

from regframe import GeometryError, Warp
from regframe.catalog import TRANSFORMS
from regframe.engine.start import begin
from regframe.geometry import Grid
from regframe.preset import Stage
from support import sitk as peer


def stage(transform):
    parts = {"interpolator": "linear", "metric": "mattes", "optimizer": "one-plus-one"}
    return Stage(start="previous", transform=transform, **parts)


def test_a_map_that_bends_is_not_dropped_in_silence():
    fixed, moving = peer.pair()
    bent = TRANSFORMS.build("bspline")
    frame = peer.frame(fixed)
    params = np.random.default_rng(1).normal(size=len(bent.identity(frame)))

    with pytest.raises(GeometryError, match="cannot continue a map that bends"):
        begin(stage("affine"), fixed, moving, Warp(bent, params, frame))


def test_other_options_of_the_same_class_keep_the_map():
    grid = Grid.of_shape((10, 12, 14))
    fixed, moving = peer.pair((10, 12, 14), grid=grid)
    before = Warp(TRANSFORMS.build("rigid"), np.array([0.2, -0.3, 0.4, 1.0, 2.0, 3.0]), peer.frame(fixed))

    found = begin(stage({"type": "rigid", "order": "zyx"}), fixed, moving, before)

    np.testing.assert_allclose(found(grid.corners()), before(grid.corners()), atol=1e-12)
