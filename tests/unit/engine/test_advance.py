"""How an optimizer's step becomes a place: sums where transforms add, rotations composed where they do."""

import numpy as np
import pytest

from regframe.catalog import TRANSFORMS
from regframe.engine.objective import Objective
from regframe.engine.run import register
from regframe.engine.scales import coordinates
from regframe.engine.scene import prepare
from regframe.geometry import Frame
from regframe.image import Image
from regframe.interpolators.base import Samples
from regframe.interpolators.linear import Linear
from regframe.preset import Level, Stage
from regframe.transforms.versor_rigid import VersorRigid
from support import sitk as peer

SHAPE = (12, 14, 16)


def problem(name, scales):
    fixed, moving = peer.pair(SHAPE)
    transform = TRANSFORMS.build(name)
    stage = Stage(
        transform=transform, interpolator="linear", metric="mattes", optimizer="one-plus-one", scales=scales
    )
    frame = Frame.about_centre(fixed.grid)
    identity = transform.identity(frame)
    params = identity + np.random.default_rng(1).uniform(-0.1, 0.1, len(identity))
    scene, _ = prepare(stage, Level(), fixed, moving, 1)
    space, at = coordinates(stage, params, frame, scene.grid, moving.grid)
    step = np.random.default_rng(2).uniform(-1.0, 1.0, len(identity))
    return Objective(stage, scene, frame, space), at, step


@pytest.mark.parametrize("name", ["translation", "rigid", "affine", "scale"])
@pytest.mark.parametrize("scales", ["shift", "physical-shift"])
def test_transforms_that_add_keep_the_bits_of_a_sum(name, scales):
    objective, at, step = problem(name, scales)

    once = objective.advance(at, step)

    assert np.array_equal(once, at + step)
    assert np.array_equal(objective.advance(once, step), once + step)


@pytest.mark.parametrize("name", ["versor-rigid", "similarity", "scale-versor", "scale-skew-versor"])
@pytest.mark.parametrize("scales", ["shift", "physical-shift"])
def test_rotations_compose_in_any_coordinates(name, scales):
    objective, at, step = problem(name, scales)
    step = 0.1 * step if scales == "physical-shift" else step
    space, transform = objective.coordinates, objective.stage.transform

    moved = objective.advance(at, step)

    wanted = transform.advance(space.params(at), step / space.unit, objective.frame)
    np.testing.assert_allclose(space.params(moved), wanted, rtol=0, atol=1e-14)


def test_motion_is_that_of_the_composed_step():
    objective, at, step = problem("versor-rigid", "shift")
    frame, space = objective.frame, objective.coordinates

    told = objective.motion(at, step)

    ends = (space.params(place) for place in (at, objective.advance(at, step)))
    here, there = (VersorRigid().map(end, frame.grid.corners(), frame) for end in ends)
    assert told == pytest.approx(np.linalg.norm(there - here, axis=1).max(), rel=1e-12)


def test_descent_in_pixels_finds_a_rotation_in_space():
    fixed = peer.pair(SHAPE, np.float64, levels=0)[0]
    frame, truth = Frame.about_centre(fixed.grid), np.array([0.03, -0.02, 0.04, 0.3, -0.2, 0.4])
    # The moving image holds the fixed values at the places that the true map comes from.
    back = VersorRigid().as_affine(truth, frame).inverse()
    at = fixed.grid.indices(back(fixed.grid.points(fixed.grid.all_indices())))
    clamped = np.clip(at, 0.0, np.array(SHAPE) - 1.0)
    moved = Linear().resample(fixed.values, Samples(SHAPE, clamped), None)[0].reshape(SHAPE)
    stage = {
        "start": "identity",
        "transform": "versor-rigid",
        "interpolator": "linear",
        "metric": "mean-squares",
        "optimizer": {"type": "regular-step-gradient-descent", "learning_rate": 0.5},
        "levels": [{"iterations": 80}],
    }

    found = register({"name": "test", "stages": [stage]}, fixed, Image(moved, fixed.grid)).warp

    corners = fixed.grid.corners()
    misfit = np.linalg.norm(found(corners) - VersorRigid().map(truth, corners, frame), axis=1)
    # Linear interpolation blurs twice, and the rim is clamped: a fifth of a pixel at the corners.
    assert misfit.mean() < 0.2
