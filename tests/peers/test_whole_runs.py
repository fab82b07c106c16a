"""Whole presets under both engines: starts, smoothing, grids, samples, scales and optimizers together."""

import numpy as np
import pytest

from regframe.catalog import TRANSFORMS
from regframe.geometry import Grid
from regframe.image import Image
from regframe.preset import parse
from support import sitk as peer
from support.runs import both

LEVELS = [
    {"shrink": 4, "smooth": 2.0, "iterations": 40},
    {"shrink": 2, "smooth": 1.0, "iterations": 40},
    {"shrink": 1, "smooth": 0.0, "iterations": 40},
]
EVOLUTION = {"type": "one-plus-one", "radius": 1.0, "epsilon": 1e-8}
# Descents are compared over few iterations: near the optimum ITK's step turns back on the sign of a slope
# that is nearly 0, and differences in the last bit grow tenfold every few steps.
SHORT = [{**level, "iterations": 5} for level in LEVELS]
DESCENT = {
    "type": "regular-step-gradient-descent",
    "learning_rate": 0.5,
    "minimum_step": 1e-5,
    "keep": "last",
}


def preset(**changes):
    stage = {
        "start": "centres",
        "transform": "similarity",
        "interpolator": {"type": "bspline", "order": 3},
        "metric": {"type": "mattes", "bins": 32},
        "optimizer": EVOLUTION,
        "scales": [400.0, 400.0, 1.0, 1.0],
        "gradient": "filtered",
        "levels": LEVELS,
        **changes,
    }
    return parse({"name": "test", "seed": 7, "stages": [stage]})


@pytest.mark.parametrize("transform", ["similarity", "affine", "rigid", "translation"])
@pytest.mark.parametrize("interpolator", ["linear", {"type": "bspline", "order": 3}])
@pytest.mark.parametrize("start", ["centres", "moments"])
def test_evolution_over_three_levels(transform, interpolator, start):
    fixed, moving = peer.pair((60, 72))
    count = {"similarity": 4, "affine": 6, "rigid": 3, "translation": 2}[transform]
    scales = [*[400.0] * (count - 2), 1.0, 1.0]

    ours, theirs = both(
        preset(transform=transform, interpolator=interpolator, start=start, scales=scales), fixed, moving
    )

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)
    np.testing.assert_allclose([p.value for p in ours.trace], [p.value for p in theirs.trace], rtol=1e-11)
    np.testing.assert_allclose(
        [p.params for p in ours.trace], [p.params for p in theirs.trace], rtol=0, atol=1e-9
    )


@pytest.mark.parametrize("scales", ["physical-shift", "index-shift", "jacobian"])
@pytest.mark.parametrize("spacing", [(1.0, 1.0), (0.8, 1.25)])
def test_descent_with_estimated_scales(scales, spacing):
    grid = Grid((60, 72), spacing, (4.0, -3.0), ((1.0, 0.0), (0.0, 1.0)))
    # float64, because on shrunk grids half the samples lie half-way between pixels: there float32 images
    # round to even or not by the last bit of a coordinate, and our fused index map has other last bits
    # than ITK's chain of three maps unless the spacing is 1.
    fixed, moving = peer.pair((60, 72), np.float64, grid=grid)
    # ITK's largest step is the spacing of the coarsest grid.
    descent = {**DESCENT, "estimate_learning_rate": "once", "maximum_step": 4 * min(spacing)}
    chosen = preset(optimizer=descent, scales=scales, interpolator="linear", levels=SHORT)

    ours, theirs = both(chosen, fixed, moving)

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)
    np.testing.assert_allclose([p.value for p in ours.trace], [p.value for p in theirs.trace], rtol=1e-9)


@pytest.mark.parametrize("gradient", ["filtered", "central"])
@pytest.mark.parametrize("metric", ["mattes", "mean-squares", "correlation"])
def test_descent_with_given_scales(gradient, metric):
    fixed, moving = peer.pair((60, 72), np.float64)
    moving = moving if metric == "mattes" else fixed.with_values(255.0 - moving.values)
    chosen = preset(
        metric=metric, gradient=gradient, optimizer={**DESCENT, "learning_rate": 0.1}, levels=SHORT
    )

    ours, theirs = both(chosen, fixed, moving)

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


OTHERS = [
    {"type": "gradient-descent", "learning_rate": 2.0, "estimate_learning_rate": "never", "keep": "last"},
    {"type": "gradient-descent-line-search", "estimate_learning_rate": "never", "keep": "itk"},
    {"type": "conjugate-gradient-line-search", "estimate_learning_rate": "never", "keep": "itk"},
    {"type": "powell", "keep": "last"},
    {"type": "exhaustive", "number_of_steps": [0, 1, 1, 2], "step_length": 0.4},
]


@pytest.mark.parametrize("optimizer", OTHERS, ids=lambda options: options["type"])
def test_other_optimizers(optimizer):
    fixed, moving = peer.pair((48, 60), np.float64)
    count = 45 if optimizer["type"] == "exhaustive" else 3
    levels = [{**level, "iterations": count} for level in LEVELS[1:]]
    if "line-search" in optimizer["type"]:
        # ITK's second level would begin with the rate that the first one's last search has found.
        levels = levels[:1]
    # A lattice's scales multiply, those of all others divide.
    scales = [1.0, 0.01, 1.0, 1.0] if optimizer["type"] == "exhaustive" else [400.0, 400.0, 1.0, 1.0]

    ours, theirs = both(preset(optimizer=optimizer, levels=levels, scales=scales), fixed, moving)

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


@pytest.mark.parametrize("optimizer", OTHERS[:3], ids=lambda options: options["type"])
def test_other_descents_with_estimated_scales(optimizer):
    fixed, moving = peer.pair((48, 60), np.float64)
    # ITK's largest step is the spacing of the coarsest grid.
    chosen = preset(
        optimizer={**optimizer, "estimate_learning_rate": "once", "maximum_step": 2.0},
        scales="physical-shift",
        levels=[{**level, "iterations": 3} for level in LEVELS[1:]],
    )

    ours, theirs = both(chosen, fixed, moving)

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


def test_amoeba_ends_at_the_same_corner():
    fixed, moving = peer.pair((48, 60), np.float64)
    optimizer = {"type": "amoeba", "parameters_tolerance": 0.05, "value_tolerance": 0.01}
    levels = [{**level, "iterations": 300} for level in LEVELS[1:]]

    ours, theirs = both(preset(optimizer=optimizer, levels=levels), fixed, moving)

    assert "tolerance" in theirs.stop
    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


@pytest.mark.parametrize("transform", ["translation", "similarity"])
def test_lbfgsb_ends_at_the_same_optimum(transform):
    fixed = Image(peer.textured((48, 60), 1), Grid.of_shape((48, 60)), name="fixed")
    # A whole number of pixels, so that the value reaches 0 there and every kind of slope vanishes.
    moving = fixed.with_values(np.roll(fixed.values, (2, -1), axis=(0, 1)))
    y, x = np.indices(fixed.grid.shape)
    fixed = fixed.with_mask((abs(x - 30) < 24) & (abs(y - 24) < 18))  # away from the wrapped rim
    optimizer = {"type": "lbfgsb", "convergence_factor": 10.0, "gradient_tolerance": 1e-9}
    chosen = preset(
        transform=transform,
        metric="mean-squares",
        optimizer=optimizer,
        scales="shift",
        gradient="exact",
        levels=[{"iterations": 200}],
    )

    ours, theirs = both(chosen, fixed, moving)

    # Corners, in pixels; other paths to the same place.
    corners = fixed.grid.corners()
    np.testing.assert_allclose(ours.warp(corners), theirs.warp(corners), atol=1e-3)
    np.testing.assert_allclose(ours.warp(corners), corners + np.array([-1.0, 2.0]), atol=1e-3)


@pytest.mark.parametrize("sampling", ["regular", "random"])
@pytest.mark.parametrize("optimizer", [EVOLUTION, DESCENT])
@pytest.mark.parametrize("masked", [False, True])
def test_sparse_samples(sampling, optimizer, masked):
    fixed, moving = peer.pair((60, 72))
    if masked:
        y, x = np.indices(fixed.grid.shape)
        fixed = fixed.with_mask((x - 36) ** 2 + (y - 30) ** 2 < 700)
    levels = [{**level, "sampling": sampling, "fraction": 0.4} for level in SHORT]

    ours, theirs = both(preset(levels=levels, optimizer=optimizer), fixed, moving)

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


def test_evolution_in_space():
    grid = Grid(
        (20, 24, 28), (1.0, 1.0, 1.5), (0.0, 0.0, 0.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    )
    fixed, moving = peer.pair((20, 24, 28), grid=grid)
    levels = [{"shrink": 2, "smooth": 1.0, "iterations": 20}, {"iterations": 20}]
    scales = [100.0] * 9 + [1.0] * 3

    ours, theirs = both(
        preset(transform="affine", interpolator="linear", levels=levels, scales=scales), fixed, moving
    )

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


SPACE = Grid(
    (16, 20, 24), (1.0, 1.1, 1.4), (3.0, 0.0, -5.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
)
COARSE_TO_FINE = [{"shrink": 2, "smooth": 1.0, "iterations": 25}, {"iterations": 25}]


@pytest.mark.parametrize("transform", ["versor-rigid", "rigid", "similarity", "scale-skew-versor"])
def test_evolution_of_rotations_in_space(transform):
    fixed, moving = peer.pair(SPACE.shape, grid=SPACE)
    family = TRANSFORMS.build(transform)
    scales = [1.0 if name.startswith("t") else 400.0 for name in family.names(peer.frame(fixed))]

    ours, theirs = both(
        preset(transform=transform, interpolator="linear", levels=COARSE_TO_FINE, scales=scales),
        fixed,
        moving,
    )

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        [p.params for p in ours.trace], [p.params for p in theirs.trace], rtol=0, atol=1e-9
    )


def test_evolution_beyond_half_a_turn():
    """The search goes on from the raw versor within a level, and from the clipped one in the next."""
    fixed, moving = peer.pair(SPACE.shape, grid=SPACE)
    optimizer = {**EVOLUTION, "radius": 0.8}
    chosen = preset(
        transform="versor-rigid",
        interpolator="linear",
        metric="mean-squares",
        optimizer=optimizer,
        levels=COARSE_TO_FINE,
        scales=[1.0] * 6,
    )

    ours, theirs = both(chosen, fixed, moving)

    # As long as a clipped one.
    assert max(np.linalg.norm(p.params[:3]) for p in ours.trace) > 1.0 - 1e-9
    np.testing.assert_allclose(
        [p.params for p in ours.trace], [p.params for p in theirs.trace], rtol=0, atol=1e-9
    )
    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)


@pytest.mark.parametrize("transform", ["versor-rigid", "rigid", "similarity"])
@pytest.mark.parametrize("scales", ["physical-shift", "jacobian"])
def test_descent_of_rotations_in_space(transform, scales):
    fixed, moving = peer.pair(SPACE.shape, np.float64, grid=SPACE)
    levels = [{**level, "iterations": 6} for level in COARSE_TO_FINE]
    descent = {**DESCENT, "estimate_learning_rate": "once", "maximum_step": 2.0}
    chosen = preset(
        transform=transform, optimizer=descent, scales=scales, interpolator="linear", levels=levels
    )

    ours, theirs = both(chosen, fixed, moving)

    np.testing.assert_allclose(ours.warp.params, theirs.warp.params, rtol=0, atol=1e-9)
    np.testing.assert_allclose([p.value for p in ours.trace], [p.value for p in theirs.trace], rtol=1e-9)
