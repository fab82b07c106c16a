"""What SimpleITK does in silence, or by ending the process, does not reach a user."""

import subprocess
import sys

import numpy as np
import pytest
import SimpleITK as sitk

import regframe
from regframe.errors import ImageError, PresetError
from regframe.geometry import Frame
from regframe.io import coerce
from regframe.peer import convert
from regframe.transforms.similarity import Similarity
from regframe.transforms.warp import Warp
from support import sitk as peer

STAGE = {
    "transform": "similarity",
    "interpolator": "linear",
    "metric": "mattes",
    "optimizer": {"type": "one-plus-one", "radius": 0.5},
    "levels": [{"shrink": 2, "smooth": 1.0, "iterations": 4}],
}

SCALED = """
import numpy as np, regframe
fixed = np.add.outer(np.sin(np.arange(30.0) / 3), np.cos(np.arange(36.0) / 4))
stage = {"transform": "similarity", "interpolator": "linear", "metric": "mean-squares",
         "optimizer": "lbfgsb", "scales": [9.0, 9.0, 1.0, 1.0], "levels": [{"iterations": 3}]}
found = regframe.register({"stages": [stage]}, fixed, np.roll(fixed, 1, axis=1), engine="simpleitk")
assert np.isfinite(found.value)
"""


@pytest.fixture(scope="module")
def pair():
    return peer.pair((30, 36))


def run(pair, *, start=None, **changes):
    preset = {"seed": 3, "stages": [{**STAGE, **changes}]}
    return regframe.register(preset, *pair, engine="simpleitk", start=start)


@pytest.mark.parametrize("count", [3, 5])
def test_scales_of_a_wrong_length_are_refused(pair, count):
    """SimpleITK takes ones instead, and says nothing."""
    with pytest.raises(PresetError, match=f"{count} numbers and the transform 4"):
        run(pair, scales=[1.0] * count)


def test_scales_beside_lbfgsb_do_not_end_the_process():
    """SimpleITK ends the process, so this is another one."""
    done = subprocess.run([sys.executable, "-c", SCALED], capture_output=True, text=True, check=False)

    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("flat", [0, 1])
@pytest.mark.parametrize("metric", ["mattes", "mean-squares", "correlation"])
def test_a_constant_image_is_named(pair, flat, metric):
    """SimpleITK's metrics raise, give 0 or the largest number, each another."""
    images = list(pair)
    images[flat] = images[flat].with_values(np.full_like(images[flat].values, 3.0))

    with pytest.raises(ImageError, match="constant"):
        run(images, metric=metric)


def test_a_start_keeps_its_own_centre(pair):
    """SimpleITK overwrites the centre where it is given the start as a moving initial transform."""
    frame = Frame(pair[0].grid, np.array([4.0, 7.0]))
    start = Warp(Similarity(), np.array([1.02, 0.03, 0.5, -0.4]), frame)

    found = run(pair, start=start)

    np.testing.assert_array_equal(found.warp.frame.centre, frame.centre)
    # The first step of the search is shorter than a pixel, so all of it lies near the start.
    corners = pair[0].grid.corners()
    assert np.abs(found.warp(corners) - start(corners)).max() < 5.0


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.int16])
def test_whole_grey_levels_are_handed_over_as_float32(dtype):
    """As float64, noise of the last bit would decide the histogram's bin of every whole number."""
    frame = np.arange(120).reshape(10, 12).astype(dtype)

    theirs = convert.image(coerce(frame, "frame"))

    assert theirs.GetPixelID() == sitk.sitkFloat32
    np.testing.assert_array_equal(sitk.GetArrayFromImage(theirs), frame)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_whole_grey_levels_fall_into_the_same_bins(dtype):
    """Edges of bins at whole numbers: every one decided otherwise shows in the metric's third digit."""
    rng = np.random.default_rng(5)
    fixed = rng.integers(0, 47, (30, 36)).astype(dtype)  # bins - 4 classes, so edges are grey levels
    moving = np.roll(fixed, 1, axis=0)
    preset = {"stages": [{**STAGE, "metric": {"type": "mattes", "bins": 50}, "levels": [{"iterations": 2}]}]}

    ours, theirs = (regframe.register(preset, fixed, moving, engine=one) for one in ("native", "simpleitk"))

    assert ours.trace[0].value == pytest.approx(theirs.trace[0].value, rel=1e-12)
