"""What the plugins' READMEs say was measured: `pytest -m slow tests/benchmarks/plugins.py -s`.

It takes some minutes, and so runs only when it is named; `tests/golden/test_plugin_presets.py` holds a
case of each plugin in every run of the tests.
"""

import numpy as np
import pytest
from scipy import ndimage

import regframe
from regframe.catalog import FILTERS, INTERPOLATORS
from regframe.interpolators.base import Samples
from regframe.testing.phantoms import corner_error, misalignment, smooth_pair, visual_thermal
from support.plugins import everywhere

pytestmark = pytest.mark.slow
SEEDS = (1, 2, 3)
WIDE = regframe.Grid.of_shape((240, 320))


@pytest.fixture(autouse=True)
def plugins(tmp_path, monkeypatch):
    """All of them, as good as installed."""
    everywhere(tmp_path, monkeypatch)


def test_cma_es_beside_one_plus_one():
    for seed in SEEDS:
        street = visual_thermal(seed, WIDE.shape)
        left = {}
        for preset in ("cma-es-similarity", "paper-similarity"):
            result = regframe.register(preset, street.fixed, street.moving)
            left[preset] = corner_error(result.warp, street.truth, WIDE)
            (level,) = result.levels
            print(
                f"street {seed}, {preset}: corner error {left[preset]:.2f} px after {level.iterations} "
                f"iterations, {level.evaluations} evaluations"
            )
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


def test_destripe_alone_and_before_a_search():
    still = misalignment(WIDE, WIDE)
    truth = misalignment(WIDE, WIDE, angle_deg=1.0, scale=1.01, shift_px=(4.3, -2.6))
    destripe = FILTERS.build("destripe")
    for offset in (40.0, 80.0, 160.0):
        for seed in SEEDS:
            rng = np.random.default_rng(seed + 9)
            gain, shift = 1 + 0.05 * rng.standard_normal(320), offset * rng.standard_normal(320)
            clean = [
                visual_thermal(seed, WIDE.shape, thermal_shape=WIDE.shape, truth=pose, noise=noise).moving
                for pose, noise in ((still, 1.0), (truth, 1.0), (still, 0.0))
            ]
            seen = [each.with_rounded(8000 + (each.values - 8000) * gain + shift) for each in clean[:2]]
            noisy, evened = (
                noise_ratio(each.values, clean[2].values) for each in (seen[0], destripe(seen[0]))
            )
            held, free = (
                corner_error(regframe.register(preset, *seen).warp, truth, WIDE)
                for preset in ("mono-similarity", "destripe-thermal")
            )
            print(
                f"offsets {offset:g}, scene {seed}: {noisy:.1f} dB, evened {evened:.1f}; "
                f"corner error {held:.3f} px, evened {free:.3f}"
            )
            assert free < held


def test_destripe_where_the_other_image_has_no_stripes():
    for seed in SEEDS:
        street = visual_thermal(seed, WIDE.shape)
        rng, columns = np.random.default_rng(seed + 9), street.moving.grid.shape[1]
        gain, offset = 1 + 0.05 * rng.standard_normal(columns), 80.0 * rng.standard_normal(columns)
        seen = street.moving.with_rounded(8000 + (street.moving.values - 8000) * gain + offset)
        held, freed = (
            corner_error(regframe.register(preset, street.fixed, seen).warp, street.truth, WIDE)
            for preset in (
                "paper-similarity-pyramid",
                regframe.load_preset("paper-similarity-pyramid", {"filters.moving": ["destripe"]}),
            )
        )
        print(f"street {seed}: corner error {held:.2f} px, evened {freed:.2f}")
        assert max(held, freed) < 2.0


def test_polynomial_after_a_lens():
    middle = (np.array(WIDE.shape) - 1) / 2
    corner = (middle**2).sum()
    pose = misalignment(WIDE, WIDE, angle_deg=1.0, scale=1.01, shift_px=(3, 2))
    points = WIDE.points(WIDE.all_indices())

    def straight(at):
        return at + 0.04 * (at - middle) * ((at - middle) ** 2).sum(axis=1, keepdims=True) / corner

    true = pose(points)[:, ::-1]
    wanted = true
    for _ in range(60):
        wanted = wanted - (straight(wanted) - true)
    inner = np.all((wanted >= 0) & (wanted <= 2 * middle), axis=1)
    for seed in SEEDS:
        street = visual_thermal(seed, WIDE.shape, truth=pose, thermal_shape=WIDE.shape)
        seen = ndimage.map_coordinates(
            street.moving.values, straight(WIDE.all_indices()).T, order=3, mode="nearest"
        )
        moving = street.moving.with_rounded(seen.reshape(WIDE.shape))
        found = []
        for preset in ("paper-similarity-pyramid", "polynomial-visual-thermal"):
            reached = regframe.register(preset, street.fixed, moving).warp(points)[:, ::-1]
            found.append(float(np.linalg.norm(reached - wanted, axis=1)[inner].mean()))
        before, after = found
        print(f"street {seed}: {before:.2f} px after the similarity, {after:.2f} px after the polynomial")
        assert after < before


def test_correlation_ratio_of_a_template_and_its_grey_matter(data):
    import SimpleITK as sitk

    place = data / "multimodal_3d"
    still, grey = (
        sitk.ReadImage(str(place / f"mni_icbm152_{kind}_tal_nlin_sym_09a_converted.nii.gz"), sitk.sitkFloat32)
        for kind in ("t1", "gm")
    )
    centre = still.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in still.GetSize()])
    known = sitk.Euler3DTransform(centre, *np.deg2rad([4.0, -3.0, 5.0]), (6.0, -5.0, 7.0))
    turned = sitk.Resample(grey, still, known.GetInverse(), sitk.sitkBSpline3, 0.0)
    brain = np.argwhere(sitk.GetArrayFromImage(still) > 0)[::5000]
    points = np.array([still.TransformIndexToPhysicalPoint(place[::-1].tolist()) for place in brain])
    true = np.array([known.TransformPoint(point) for point in points.tolist()])

    result = regframe.register("correlation-ratio-rigid", still, turned)

    left = float(np.linalg.norm(result.warp(points) - true, axis=1).mean())
    print(f"{np.linalg.norm(true - points, axis=1).mean():.1f} mm at the start, {left:.3f} mm at the end")
    assert left < 0.1


def test_cross_cumulative_residual_entropy_on_bent_slices(data):
    place = data / "multimodal_2d" / "itk_brain"
    fixed, other = (
        regframe.read(place / f"Brain{kind}SliceBorder20.png") for kind in ("T1", "ProtonDensity")
    )
    shape, brain = fixed.grid.shape, fixed.values.ravel() > 20
    points = fixed.grid.points(fixed.grid.all_indices())
    ways = {"normalized": {}, "the paper's": {"normalized": False}, "mattes": None}
    for seed in (1, 2):
        rng = np.random.default_rng(seed + 50)
        width = min(shape) / 9
        drawn = [ndimage.gaussian_filter(rng.standard_normal(shape), width, mode="wrap") for _ in shape]
        bend = np.array([5.0 * each / np.abs(each).max() for each in drawn])
        rest = np.indices(shape, dtype=np.float64)
        seen = ndimage.map_coordinates(other.values, rest + bend, order=3, mode="nearest")
        wanted = rest.reshape(2, -1)
        for _ in range(50):
            away = [ndimage.map_coordinates(each, wanted, order=1, mode="nearest") for each in bend]
            wanted = rest.reshape(2, -1) - np.array(away)
        for name, options in ways.items():
            metric = {"type": "cross-cumulative-residual-entropy", **(options or {})}
            chosen = {"type": "mattes", "bins": 32} if options is None else metric
            changed = regframe.load_preset(
                "cross-cumulative-bspline", {"stages.0.metric": chosen, "stages.1.metric": chosen}
            )
            warp = regframe.register(changed, fixed, other.with_values(seen)).warp
            left = np.linalg.norm(warp(points)[:, ::-1].T - wanted, axis=0)[brain].mean()
            start = np.linalg.norm(rest.reshape(2, -1) - wanted, axis=0)[brain].mean()
            print(f"bend {seed}, {name}: {left:.2f} px of {start:.2f}")
            assert left < 0.5


def test_cross_cumulative_residual_entropy_as_in_the_paper_on_smooth_phantoms():
    rest = np.indices((96, 110), dtype=np.float64)
    bend = 4.0 * np.array([np.sin(rest[1] / 25.0), np.sin(rest[0] / 22.0)])
    for seed in SEEDS:
        pair = smooth_pair("multimodal", (96, 110), seed=seed)
        seen = ndimage.map_coordinates(pair.moving.values, rest + bend, order=3, mode="nearest")
        left = {}
        for normalized in (True, False):
            metric = {"type": "cross-cumulative-residual-entropy", "normalized": normalized}
            preset = regframe.load_preset(
                "cross-cumulative-bspline", {"stages.0.metric": metric, "stages.1.metric": metric}
            )
            warp = regframe.register(preset, pair.fixed, pair.moving.with_values(seen)).warp
            reached = warp(pair.fixed.grid.points(pair.fixed.grid.all_indices()))[:, ::-1].T
            back = [ndimage.map_coordinates(each, reached, order=1, mode="nearest") for each in bend]
            missed = np.linalg.norm(reached + np.array(back) - rest.reshape(2, -1), axis=0)
            left[normalized] = missed.reshape(96, 110)[8:-8, 8:-8].mean()
        print(f"phantom {seed}: {left[True]:.2f} px normalized, {left[False]:.2f} px as in the paper")
        assert left[True] < 1.0
