"""Weights and frozen parameters under both engines, in each optimizer's own way."""

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.errors import NoTwin
from regframe.geometry import Grid
from regframe.peer.convert import image
from regframe.peer.simpleitk import SimpleITKEngine, told_preset
from regframe.peer.whole import finished
from regframe.preset import parse
from support import sitk as peer
from support.runs import both

WEIGHTS = [0.5, 0.0, 1.0, 0.25]
SCALES = [400.0, 400.0, 1.0, 1.0]
LEVELS = [{"shrink": 2, "smooth": 1.0, "iterations": 4}, {"iterations": 4}]
DESCENTS = [
    {"type": "gradient-descent", "learning_rate": 2.0, "estimate_learning_rate": "never", "keep": "last"},
    {"type": "regular-step-gradient-descent", "learning_rate": 0.3, "minimum_step": 1e-5, "keep": "last"},
    {"type": "gradient-descent-line-search", "estimate_learning_rate": "never", "keep": "itk"},
    {"type": "conjugate-gradient-line-search", "estimate_learning_rate": "never", "keep": "itk"},
]
by_descent = pytest.mark.parametrize("optimizer", DESCENTS, ids=lambda options: options["type"])


def preset(**changes):
    stage = {
        "transform": "similarity",
        "interpolator": "linear",
        "metric": {"type": "mattes", "bins": 24},
        "optimizer": DESCENTS[0],
        "scales": SCALES,
        "gradient": "filtered",
        "levels": LEVELS,
        **changes,
    }
    return parse({"name": "test", "seed": 5, "stages": [stage]})


def one_level(optimizer):
    # ITK's second level would begin with the rate that the first one's last search has found.
    return LEVELS[:1] if "line-search" in optimizer["type"] else LEVELS


@by_descent
@pytest.mark.parametrize(
    "scales", [SCALES, [1.005, 0.995, 1.0, 1.002]], ids=["scales", "scales that are nearly ones"]
)
def test_descents_weigh_slopes_alike(optimizer, scales):
    fixed, moving = peer.pair((48, 60), np.float64, levels=0)
    if scales != SCALES:
        optimizer = {**optimizer, "learning_rate": 0.003}
    chosen = preset(optimizer=optimizer, weights=WEIGHTS, levels=one_level(optimizer), scales=scales)

    ours, theirs = both(chosen, fixed, moving)

    first = ours.start.params
    assert ours.warp.params[1] == first[1]
    assert np.all(ours.warp.params[[0, 2, 3]] != first[[0, 2, 3]])
    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)
    np.testing.assert_allclose([p.value for p in ours.trace], [p.value for p in theirs.trace], rtol=1e-10)


@by_descent
def test_estimated_rates_follow_the_weights(optimizer):
    fixed, moving = peer.pair((48, 60), np.float64, levels=0)
    optimizer = {**optimizer, "estimate_learning_rate": "once", "maximum_step": 2.0}
    chosen = preset(
        optimizer=optimizer, weights=WEIGHTS, levels=one_level(optimizer), scales="physical-shift"
    )

    ours, theirs = both(chosen, fixed, moving)

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


def test_weights_that_are_nearly_ones_are_ones():
    fixed, moving = peer.pair((48, 60), np.float64, levels=0)
    chosen = preset(weights=[1.00005, 1.0, 0.99995, 1.0])

    ours, theirs = both(chosen, fixed, moving)

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)
    plain, _ = both(preset(), fixed, moving)
    np.testing.assert_array_equal(ours.warp.params, plain.warp.params)


@by_descent
def test_frozen_is_a_weight_of_zero(optimizer):
    fixed, moving = peer.pair((48, 60), np.float64, levels=0)
    levels = one_level(optimizer)

    ours, theirs = both(preset(optimizer=optimizer, frozen=["angle_rad"], levels=levels), fixed, moving)
    weighed, _ = both(preset(optimizer=optimizer, weights=[1.0, 0.0, 1.0, 1.0], levels=levels), fixed, moving)

    np.testing.assert_array_equal(ours.warp.params, weighed.warp.params)
    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


SEARCHES = [
    {"type": "one-plus-one", "radius": 0.7, "epsilon": 1e-8},
    {"type": "powell", "keep": "last"},
    {"type": "exhaustive", "number_of_steps": [1], "step_length": 0.4},
    {"type": "exhaustive", "number_of_steps": [1, 2, 0], "step_length": 0.4},
]


@pytest.mark.parametrize("optimizer", SEARCHES, ids=lambda options: options["type"])
@pytest.mark.parametrize("scales", [SCALES, "physical-shift", "shift"], ids=str)
def test_searches_without_slopes_freeze_alike_as_told(optimizer, scales):
    fixed, moving = peer.pair((48, 60), np.float64, levels=0)
    if optimizer["type"] == "exhaustive":
        scales = [1.0, 0.01, 1.0, 1.0]
    count = {"one-plus-one": 15, "powell": 2, "exhaustive": 27}[optimizer["type"]]
    levels = [{"shrink": 2, "smooth": 1.0, "iterations": count}, {"iterations": count}]
    chosen = preset(optimizer=optimizer, frozen=["angle_rad"], levels=levels, scales=scales)

    theirs = finished(SimpleITKEngine(), chosen, (fixed, moving))
    ours, _ = both(told_preset(chosen, theirs.provenance), fixed, moving)

    assert any("freez" in note or "frozen" in note for note in theirs.provenance["notes"])
    np.testing.assert_allclose(theirs.warp.params[1], theirs.start.params[1], rtol=0, atol=1e-25)
    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-8)


def test_their_quasi_newton_method_cannot_freeze():
    fixed, moving = peer.pair((48, 60), np.float64, levels=0)
    chosen = preset(optimizer="lbfgsb", frozen=["angle_rad"], scales="shift", gradient="exact")

    with pytest.raises(NoTwin, match="cannot freeze"):
        finished(SimpleITKEngine(), chosen, (fixed, moving))


def test_their_evolution_ignores_weights():
    """Why regframe refuses weights there: SimpleITK takes them and does nothing with them."""
    fixed, moving = peer.pair((48, 60), np.float64, levels=0)

    def ended(weights):
        method = peer.method(fixed, moving, "linear")
        method.SetOptimizerAsOnePlusOneEvolutionary(20, 1e-8, 0.5, 1.05, -1, 3)
        method.SetOptimizerScales(SCALES)
        method.SetOptimizerWeights(weights)
        moved = sitk.Similarity2DTransform()
        method.SetInitialTransform(moved, True)
        method.Execute(image(fixed), image(moving))
        return moved.GetParameters()

    assert ended([1.0, 0.0, 0.0, 1.0]) == ended([1.0, 1.0, 1.0, 1.0])


def test_rotations_in_space_freeze_alike():
    grid = Grid(
        (14, 18, 20), (1.0, 1.1, 1.4), (3.0, 0.0, -5.0), ((0.6, 0.0, -0.8), (0.0, -1.0, 0.0), (0.8, 0.0, 0.6))
    )
    fixed, moving = peer.pair(grid.shape, np.float64, levels=0, grid=grid)
    chosen = preset(
        transform="versor-rigid",
        optimizer=DESCENTS[1],
        frozen=["vx", "tz"],
        scales=[400.0] * 3 + [1.0] * 3,
    )

    ours, theirs = both(chosen, fixed, moving)

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)
