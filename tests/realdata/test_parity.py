"""Every preset that both engines can run ends at the same place on real images, in two and three dimensions.

``pytest -m slow tests/realdata/test_parity.py -s`` prints how far apart the corners end.
"""

import sys
from functools import cache

import numpy as np
import pytest
import SimpleITK as sitk

from regframe import preset as presets
from regframe.engine.native import Native
from regframe.engine.run import as_preset
from regframe.engine.setting import Placement, opened
from regframe.engine.start import begin
from regframe.io import coerce, read
from regframe.peer.method import Part
from regframe.peer.probe import value_and_count
from regframe.peer.simpleitk import SimpleITKEngine, told_preset
from regframe.peer.whole import apart, finished
from regframe.transforms.warp import Warp
from support.shipped import NAMES, NATIVE_ONLY, OWN_WAYS, dimensions, shortened, without_slopes

pytestmark = pytest.mark.slow

EVOLUTION = 20
"""Iterations a level of searches without slopes: they walk bit for bit, so that more show nothing more."""
VOLUMES = 6
"""Iterations a level of descents over many points of a volume, which take SimpleITK half a second each."""
BENT = 1
"""The same with splines, on coarser volumes; half their meshes leave a thousand parameters of six."""
EXACT, CLOSE = 1e-6, 1e-4
"""Pixels (or mm) between the corners, of searches by values and of descents."""

CHAOTIC = {
    ("ants-affine", 2): 10,
    ("ants-rigid-affine", 2): 10,
    ("ants-similarity", 2): 4,
    ("brain-ct-mr", 3): 3,
    ("elastix-affine", 2): 30,
    ("elastix-rigid", 3): 20,
}
"""Descents that cannot agree to their ends, and the iterations a level over which they do.

Near the optimum, on rough values or few samples, they amplify a difference in the last bit until it is
seen: `test_itself_ends_elsewhere` shows that SimpleITK's own run from a start 1e-13 away does so too.
"""

CASES = [
    (name, dim)
    for name in NAMES
    if name not in {**NATIVE_ONLY, **OWN_WAYS} or name.startswith("sitk-exhaustive")
    for dim in dimensions(presets.load(name))
]


@pytest.fixture(autouse=True)
def one_thread(monkeypatch):
    """SimpleITK's slopes are summed in the order in which its threads end: two runs differ in bits."""
    monkeypatch.setenv("REGFRAME_THREADS", "1")


@cache
def scene(data):
    """A visual and a thermal frame."""
    folder = data / "visual_thermal" / "roadscene"
    return tuple(read(folder / kind / "FLIR_00060.jpg") for kind in ("visual", "thermal"))


@cache
def slices(data, below):
    """A slice of a head and a turned one of its proton density."""
    folder = data / "multimodal_2d" / "itk_brain"
    return read(folder / f"Brain{below}SliceBorder20.png"), read(
        folder / "BrainProtonDensitySliceR10X13Y17.png"
    )


@cache
def heads(data, kind, size=3):
    """A head's T1 in voxels of some mm and a turned copy of it, or CT and T1."""
    folder = data / "multimodal_3d"
    first = sitk.ReadImage(str(folder / "mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz"), sitk.sitkFloat32)
    still = sitk.BinShrink(first, [size] * 3)
    if kind == "ct":
        scan = sitk.ReadImage(str(folder / "ct_template_2mm.nii"), sitk.sitkFloat32)
        return coerce(scan, "ct"), coerce(still, "t1")
    centre = still.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in still.GetSize()])
    known = sitk.Euler3DTransform(centre, *np.deg2rad([4.0, -3.0, 5.0]), (6.0, -5.0, 7.0))
    moved = sitk.Resample(still, still, known.GetInverse(), sitk.sitkBSpline3, 0.0)
    return coerce(still, "t1"), coerce(moved, "moved")


def images(data, name, dim):
    """A pair that suits a preset."""
    if dim == 3:
        coarse = "bspline" in name or "exhaustive" in name
        return heads(data, "ct" if "ct" in name else "t1", 10 if coarse else 3)
    if name.startswith("brain-slices"):
        return slices(data, "T1")
    if name.startswith(("paper", "matlab-multimodal", "elastix")):
        return scene(data)
    return slices(data, "ProtonDensity")


def cut(name, dim):
    """The preset with the iterations that are compared."""
    whole = presets.load(name)
    if without_slopes(whole):
        return shortened(name, EVOLUTION)
    many = any(level.fraction > 0.1 for stage in whole.stages for level in stage.levels)
    bent = any(not stage.transform.closed for stage in whole.stages)
    most = (BENT if bent else VOLUMES) if dim == 3 and many else np.inf
    cut_short = shortened(name, min(most, CHAOTIC.get((name, dim), np.inf)))
    return halved(cut_short) if dim == 3 and bent else cut_short


def halved(chosen):
    """The preset with half the cells of its mesh."""
    stages = [stage.model_dump(mode="json") for stage in chosen.stages]
    for stage in stages:
        if "mesh" in stage["transform"]:
            stage["transform"]["mesh"] = [n // 2 for n in stage["transform"]["mesh"]]
    return presets.parse({"name": chosen.name, "seed": chosen.seed, "stages": stages})


def compare(chosen, pair):
    """How far apart the corners end."""
    theirs = finished(SimpleITKEngine(), chosen, pair)
    ours = finished(Native(), told_preset(chosen, theirs.provenance), pair)
    found = apart(ours.warp, theirs.warp)
    sys.stdout.write(f"{found:.1e} after {len(ours.trace)} and {len(theirs.trace)} iterations ")
    return found


@pytest.mark.parametrize(("name", "dim"), CASES)
def test_both_engines_end_at_the_same_place(data, name, dim):
    chosen = cut(name, dim)

    found = compare(chosen, images(data, name, dim))

    assert found <= (EXACT if without_slopes(chosen) else CLOSE)


@pytest.mark.parametrize(("name", "dim"), list(CHAOTIC))
def test_itself_ends_elsewhere(data, name, dim):
    """A bound on iterations is earned: SimpleITK from a start that no one can tell apart ends elsewhere."""
    chosen, pair = as_preset(name), images(data, name, dim)
    start = begin(chosen.stages[0], *pair, None)
    signs = np.random.default_rng(3).choice([-1.0, 1.0], len(start.params))
    near = Warp(start.transform, start.params + 1e-13 * signs, start.frame)

    one, other = (run_from(chosen, pair, place) for place in (start, near))

    found = apart(one.warp, other.warp)
    sys.stdout.write(f"{found:.1e} ")
    assert found > CLOSE


def run_from(chosen, pair, start):
    """SimpleITK's result from a given start."""
    walk = SimpleITKEngine().iterate(chosen, *pair, start=start)
    while True:
        try:
            next(walk)
        except StopIteration as end:
            return end.value


POWELL = {"type": "powell", "keep": "last"}
SIMPLEX = {"type": "amoeba", "parameters_tolerance": 0.05, "value_tolerance": 0.01}
ROUGH = ("linear", 1.0, 1)
"""Interpolator, smoothing and iterations under which Powell's walk hangs on the last bits of values."""


def searched(optimizer, interpolator, smooth, iterations):
    """A preset with an optimizer that none has."""
    changes = {
        "stages.0.optimizer": optimizer,
        "stages.0.levels": [{"shrink": 2, "smooth": smooth, "iterations": iterations}],
        "stages.0.interpolator": interpolator,
    }
    return presets.load("paper-similarity", changes)


@pytest.mark.parametrize(
    ("optimizer", "dim", "options"),
    [
        (POWELL, 2, ("linear", 4.0, 3)),
        (POWELL, 3, ("bspline", 8.0, 2)),
        (SIMPLEX, 2, ("linear", 1.0, 300)),
        (SIMPLEX, 3, ("linear", 1.0, 300)),
    ],
    ids=lambda value: value["type"] if isinstance(value, dict) else "",
)
def test_optimizers_that_no_preset_uses(data, optimizer, dim, options):
    pair = slices(data, "ProtonDensity") if dim == 2 else heads(data, "t1", 6 if optimizer is POWELL else 3)

    found = compare(searched(optimizer, *options), pair)

    assert found <= EXACT


@pytest.mark.parametrize("dim", [2, 3])
def test_powell_walks_the_same_way_on_its_values(data, dim):
    """Its line searches fit parabolas, which divide differences of last bits by each other."""
    pair = scene(data) if dim == 2 else heads(data, "t1", 6)
    theirs = finished(SimpleITKEngine(), searched(POWELL, *ROUGH), pair)
    stage = told_preset(theirs.preset, theirs.provenance).stages[0]
    setting = opened(Placement(), pair[0]).entered(stage, None)
    part = Part(stage, stage.levels, 0, setting)

    first = theirs.start

    class ItsValues:
        scales = np.array(stage.scales)

        def values(self, batch):
            warps = [Warp(first.transform, row, first.frame) for row in batch]
            return np.array([value_and_count(part, *pair, warp)[0] for warp in warps])

    step = next(stage.optimizer.steps(ItsValues(), first.params, None))

    np.testing.assert_array_equal(step.params, theirs.warp.params)


@pytest.mark.parametrize("dim", [2, 3])
def test_powell_itself_ends_elsewhere_with_other_threads(data, monkeypatch, dim):
    """Threads change the last bits of SimpleITK's sums, and with them where its own walk ends."""
    pair, ends = scene(data) if dim == 2 else heads(data, "t1", 6), []
    for threads in ("1", "3"):
        monkeypatch.setenv("REGFRAME_THREADS", threads)
        ends.append(finished(SimpleITKEngine(), searched(POWELL, *ROUGH), pair).warp)

    found = apart(*ends)

    sys.stdout.write(f"{found:.1e} ")
    assert found > EXACT
