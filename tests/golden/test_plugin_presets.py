"""The preset of each plugin finds a known truth, and does what it is for."""

import numpy as np
import pytest
from scipy import ndimage

import regframe
from regframe.interpolators.linear import Linear
from regframe.testing.phantoms import corner_error, misalignment, smooth_pair, visual_thermal
from support.plugins import everywhere

WIDE = regframe.Grid.of_shape((240, 320))


@pytest.fixture(autouse=True)
def plugins(tmp_path, monkeypatch):
    """All of them, as good as installed."""
    everywhere(tmp_path, monkeypatch)


def moved(image, away):
    """An image whose pixel at `index + away(index)` is shown at `index`; both are in array order."""
    indices = np.indices(image.grid.shape, dtype=np.float64)
    values = ndimage.map_coordinates(image.values, indices + away(indices), order=3, mode="nearest")
    return image.with_values(values)


def left(result, image, away, rim=8):
    """Mean distance in pixels between where pixels went and where they should have, away from the rim."""
    places = result.warp(image.grid.points(image.grid.all_indices()))[:, ::-1]
    wanted = places + np.stack([axis.ravel() for axis in away(places.T)], axis=1)
    missed = np.sqrt(((wanted - image.grid.all_indices()) ** 2).sum(axis=1))
    inner = np.zeros(image.grid.shape, dtype=np.bool_)
    inner[(slice(rim, -rim),) * image.dim] = True
    return float(missed[inner.ravel()].mean())


def test_correlation_ratio_brings_volumes_together():
    pair = smooth_pair("multimodal", (44, 48, 52))

    def away(at):
        return np.array([3.0, -2.0, 2.5]).reshape(3, *[1] * (at.ndim - 1)) + 0 * at

    result = regframe.register("correlation-ratio-rigid", pair.fixed, moved(pair.moving, away))

    assert left(result, pair.fixed, away) < 0.2  # of 4.4 at the start, with some 700 samples a level


def bend(at):
    """Up to four pixels, three quarters of a wave over the image."""
    y, x = at
    return np.array([4.0 * np.sin(x / 25.0), 4.0 * np.sin(y / 22.0)])


def test_cross_cumulative_residual_entropy_follows_a_bend():
    pair = smooth_pair("multimodal", (96, 110))

    result = regframe.register("cross-cumulative-bspline", pair.fixed, moved(pair.moving, bend))

    # The bend is of 3.7 px on average, and a mesh of 6 cells has not all of it.
    assert left(result, pair.fixed, bend) < 0.8


@pytest.mark.slow
def test_polynomial_follows_a_lens():
    street = visual_thermal(3, WIDE.shape, truth=misalignment(WIDE, WIDE), thermal_shape=WIDE.shape)
    middle = (np.array(WIDE.shape) - 1) / 2

    def away(at):
        from_middle = at - middle.reshape(2, *[1] * (at.ndim - 1))
        return 0.04 * from_middle * (from_middle**2).sum(axis=0) / (middle**2).sum()

    moving = moved(street.moving, away)
    after = regframe.register("polynomial-visual-thermal", street.fixed, moving)
    before = regframe.register("paper-similarity-pyramid", street.fixed, moving)

    assert left(after, street.fixed, away) < 0.35
    assert left(after, street.fixed, away) < 0.6 * left(before, street.fixed, away)


def test_cma_es_ends_nearer_than_one_plus_one():
    street = visual_thermal(1, WIDE.shape)

    found = regframe.register("cma-es-similarity", street.fixed, street.moving)
    other = regframe.register("paper-similarity", street.fixed, street.moving)

    assert corner_error(found.warp, street.truth, WIDE) < 0.15
    assert corner_error(found.warp, street.truth, WIDE) < corner_error(other.warp, street.truth, WIDE)


def test_lanczos_keeps_detail_that_linear_interpolation_blurs():
    rng = np.random.default_rng(1)
    waves = rng.uniform(-0.2, 0.2, (60, 2))
    grid, shift = regframe.Grid.of_shape((80, 90)), np.array([1.3, -0.6])
    points = grid.points(grid.all_indices())
    fixed = regframe.Image.of_array(np.cos(2 * np.pi * points @ waves.T).sum(axis=1).reshape(grid.shape))
    moving = regframe.Image.of_array(
        np.cos(2 * np.pi * (points - shift) @ waves.T).sum(axis=1).reshape(grid.shape)
    )

    result = regframe.register("lanczos-sharp", fixed, moving)
    sharp, blurred = (
        regframe.align(moving, grid, result.warp, way)
        for way in (result.preset.stages[-1].interpolator, Linear())
    )

    def missed(values):
        return np.abs(values - fixed.values)[8:-8, 8:-8].mean()

    assert corner_error(result.warp, misalignment(grid, grid, shift_px=shift), grid) < 0.02
    assert missed(sharp) < 0.25 * missed(blurred)


def test_destripe_frees_the_search_from_the_sensors_pattern():
    still = misalignment(WIDE, WIDE)
    truth = misalignment(WIDE, WIDE, angle_deg=1.0, scale=1.01, shift_px=(4.3, -2.6))
    rng = np.random.default_rng(11)
    gain, offset = 1 + 0.05 * rng.standard_normal(320), 160.0 * rng.standard_normal(320)
    clean = [
        visual_thermal(2, WIDE.shape, thermal_shape=WIDE.shape, truth=pose).moving for pose in (still, truth)
    ]
    seen = [frame.with_rounded(8000 + (frame.values - 8000) * gain + offset) for frame in clean]

    found = regframe.register("destripe-thermal", *seen)
    held = regframe.register("mono-similarity", *seen)

    assert corner_error(found.warp, truth, WIDE) < 0.15
    assert corner_error(held.warp, truth, WIDE) > 3.0


def test_destripe_brings_the_scene_back():
    from regframe_destripe import Destripe

    rng = np.random.default_rng(12)
    scene = visual_thermal(2, WIDE.shape, noise=0.0).moving
    columns = scene.grid.shape[1]
    striped = scene.values * (1 + 0.05 * rng.standard_normal(columns)) + 80.0 * rng.standard_normal(columns)

    evened = Destripe()(scene.with_rounded(striped))

    def missed(values):
        away = values - scene.values
        return float(np.sqrt(((away - away.mean()) ** 2).mean()))

    assert missed(evened.values) < 0.5 * missed(striped)
