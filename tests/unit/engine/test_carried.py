import numpy as np
import pytest

from regframe import register
from regframe.engine.carried import CarriedObjective
from regframe.engine.objective import Objective
from regframe.engine.scales import coordinates
from regframe.engine.scene import prepare
from regframe.errors import GeometryError, PresetError
from regframe.image import Image
from regframe.preset import parse
from regframe.testing.phantoms import visual_thermal
from regframe.transforms.warp import Warp

METRIC = {"type": "oriented-gradients", "inner": 0.7, "outer": 1.0}


def preset(**changes):
    stage = {
        "start": "identity",
        "transform": "similarity",
        "interpolator": "linear",
        "metric": METRIC,
        "optimizer": "bfgs",
        "levels": [{"iterations": 20, "carried": True}],
    }
    return parse({"stages": [{**stage, **changes}]})


@pytest.fixture(scope="module")
def pair():
    return visual_thermal(seed=2, shape=(120, 160))


@pytest.fixture(scope="module")
def objectives(pair):
    """Exact and carried, about the true map."""
    stage, frame = preset().stages[0], pair.truth.frame
    params = stage.transform.from_affine(pair.truth.as_affine(), frame)
    scene, _ = prepare(stage, stage.levels[0], pair.fixed, pair.moving, 1)
    space, _ = coordinates(stage, params, frame, scene.grid, pair.moving.grid)
    return Objective(stage, scene, frame, space), CarriedObjective(stage, scene, frame, space, params)


@pytest.mark.parametrize("step", [(0.3, -0.2, 0.5, 0.1), (1.0, -1.0, 1.0, -1.0), (-2.0, 1.0, 0.5, 2.5)])
def test_is_near_the_metric_that_is_made_anew(objectives, step):
    exact, carried = (one.value_and_gradient(np.array(step)) for one in objectives)

    assert carried[0] == pytest.approx(exact[0], abs=0.02)
    assert carried[1] @ exact[1] > 0.9 * np.linalg.norm(carried[1]) * np.linalg.norm(exact[1])


def test_slope_is_that_of_its_own_value(objectives):
    carried, at, reach = objectives[1], np.array([0.4, -0.7, 0.9, 1.2]), 0.02
    steps = reach * np.eye(4)

    slope = carried.value_and_gradient(at)[1]

    # Slopes hold the weights; points that come and go at the border make the difference.
    ahead, behind = (carried.values(at + side * steps) for side in (1, -1))
    np.testing.assert_allclose(slope, (ahead - behind) / (2 * reach), atol=0.08 * np.abs(slope).max())


def test_a_carried_level_ends_within_half_a_pixel_of_the_truth(pair):
    near = Warp.of_affine(pair.truth.as_affine(), pair.truth.frame)
    start = preset().stages[0].transform.from_affine(near.as_affine(), pair.truth.frame)
    start = start + np.array([0.004, 0.004, 0.8, -0.6])

    result = register(
        preset(), pair.fixed, pair.moving, start=Warp(preset().stages[0].transform, start, pair.truth.frame)
    )

    corners = pair.fixed.grid.corners()
    assert np.linalg.norm(result.warp(corners) - pair.truth(corners), axis=1).max() < 0.5
    # The metric itself is told, not what was carried.
    assert result.value == pytest.approx(
        register(preset(levels=[{"iterations": 1}]), pair.fixed, pair.moving, start=result.warp)
        .levels[0]
        .start_value
    )


def test_a_metric_without_features_is_refused():
    with pytest.raises(PresetError, match=r"levels\.0\.carried: the metric 'mattes' has no features"):
        preset(metric="mattes")


def test_volumes_are_refused():
    block = Image.of_array(np.random.default_rng(0).random((12, 14, 16)))

    with pytest.raises(GeometryError, match=r"carried features are for 2-D images\. Got 3-D"):
        register(preset(), block, block)


def test_maps_that_bend_are_refused(pair):
    with pytest.raises(GeometryError, match=r"only maps without bends carry features\. Got BSpline"):
        register(preset(transform="bspline"), pair.fixed, pair.moving)
