"""What the plugins' READMEs say was measured: `pytest -m slow tests/benchmarks/test_plugins.py -s`."""

import numpy as np
import pytest

import regframe
from regframe.catalog import INTERPOLATORS
from regframe.interpolators.base import Samples
from regframe.testing.phantoms import corner_error, misalignment, visual_thermal
from support.plugins import FOLDERS, install

pytestmark = pytest.mark.slow
SEEDS = (1, 2, 3)
WIDE = regframe.Grid.of_shape((240, 320))


@pytest.fixture(autouse=True)
def plugins(tmp_path, monkeypatch):
    """All of them, as good as installed."""
    for folder in FOLDERS:
        install(folder, tmp_path)
        monkeypatch.syspath_prepend(folder)
    monkeypatch.syspath_prepend(tmp_path)


def test_cma_es_beside_one_plus_one():
    for seed in SEEDS:
        street = visual_thermal(seed, WIDE.shape)
        left = {}
        for preset in ("cma-es-similarity", "paper-similarity"):
            result = regframe.register(preset, street.fixed, street.moving)
            left[preset] = corner_error(result.warp, street.truth, WIDE)
        print(f"street {seed}: corner error, px: {left}")
        assert left["cma-es-similarity"] < left["paper-similarity"]


def noise_ratio(values, truth):
    return float(20 * np.log10(np.ptp(truth) / np.sqrt(((values - truth) ** 2).mean())))


def test_lanczos_beside_the_other_interpolators():
    grid = regframe.Grid.of_shape((120, 160))
    points = grid.points(grid.all_indices())
    truth = misalignment(grid, grid, angle_deg=2.0, scale=1.01, shift_px=(1.3, -0.6))
    reached = truth(points)
    inner = np.all((reached > 5) & (reached < np.array([154, 114])), axis=1)
    ways = ("linear", {"type": "lanczos", "radius": 2}, "lanczos", "bspline", "windowed-sinc")
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        waves = rng.uniform(-1, 1, (150, 2))
        waves *= (rng.uniform(0.01, 0.3, 150) / np.linalg.norm(waves, axis=1))[:, None]
        phase, height = rng.uniform(0, 2 * np.pi, 150), 1 / (0.05 + np.linalg.norm(waves, axis=1))
        fixed, moving = (
            (np.cos(2 * np.pi * at @ waves.T + phase) * height).sum(axis=1)
            for at in (points, truth.inverse()(points))
        )
        found = []
        for way in ways:
            chosen = INTERPOLATORS.build(way)
            volume = chosen.prepare(moving.reshape(grid.shape))
            samples = Samples(grid.shape, np.ascontiguousarray(reached[:, ::-1]))
            values = chosen.resample(volume, samples, None)[0]
            found.append(noise_ratio(values[inner], fixed[inner]))
        print(f"texture {seed}: dB of {ways}: {np.round(found, 1)}")
        assert found[2] > found[1] > found[0]
