"""The SimpleITK engine: progress while it runs, its traps, its errors and reports."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import regframe
from regframe.errors import ImageError, NoOverlapError, NoTwin, PresetError
from regframe.geometry import Frame
from regframe.peer.simpleitk import SimpleITKEngine
from regframe.preset import parse
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Warp
from support import sitk as peer

STAGE = {
    "transform": "similarity",
    "interpolator": "linear",
    "metric": "mattes",
    "optimizer": {"type": "one-plus-one", "radius": 0.5},
    "levels": [{"shrink": 2, "smooth": 1.0, "iterations": 6}, {"iterations": 6}],
}
DESCENT = {"type": "regular-step-gradient-descent", "learning_rate": 0.5}


@pytest.fixture(scope="module")
def pair():
    return peer.pair((30, 36))


def run(pair, *, start=None, **changes):
    preset = {"seed": 3, "stages": [{**STAGE, **changes}]}
    return regframe.register(preset, *pair, engine="simpleitk", start=start)


def test_is_found_by_name_and_named_in_the_provenance(pair):
    assert run(pair).provenance["engine"] == "simpleitk"


def test_an_unknown_engine_is_answered_with_the_nearest(pair):
    with pytest.raises(PresetError, match="Did you mean 'simpleitk'"):
        regframe.register("paper-similarity", *pair, engine="simple-itk")


def test_progress_comes_while_it_runs(pair):
    steps = SimpleITKEngine().iterate(parse({"stages": [STAGE]}), *pair)

    first = next(steps)

    assert (first.stage, first.level, first.iteration, first.iterations) == (0, 0, 0, 6)
    assert len(first.params) == 4
    steps.close()
    assert not any(thread.name == "regframe-simpleitk" for thread in threading.enumerate())


def test_an_error_of_an_observer_ends_the_run(pair):
    def observer(progress):
        if progress.iteration == 2:
            message = "enough"
            raise ValueError(message)

    with pytest.raises(ValueError, match="enough"):
        regframe.register({"stages": [STAGE]}, *pair, engine="simpleitk", observers=[observer])

    assert not any(thread.name == "regframe-simpleitk" for thread in threading.enumerate())


@pytest.mark.skipif(os.name == "nt", reason="sends a signal of POSIX")
def test_control_c_ends_the_run(pair):
    def observer(progress):
        if progress.iteration == 1:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.05)

    with pytest.raises(KeyboardInterrupt):
        regframe.register({"stages": [STAGE]}, *pair, engine="simpleitk", observers=[observer])

    assert not any(thread.name == "regframe-simpleitk" for thread in threading.enumerate())


@pytest.mark.parametrize("optimizer", [STAGE["optimizer"], DESCENT])
def test_reports_levels_as_the_native_engine_does(pair, optimizer):
    theirs = run(pair, optimizer=optimizer, scales="physical-shift", gradient="filtered")

    ours = regframe.register(
        {
            "seed": 3,
            "stages": [{**STAGE, "optimizer": optimizer, "scales": "physical-shift", "gradient": "filtered"}],
        },
        *pair,
    )

    for one, other in zip(ours.levels, theirs.levels, strict=True):
        assert (one.stage, one.level, one.shape, one.samples) == (
            other.stage,
            other.level,
            other.shape,
            other.samples,
        )
        assert (one.iterations, one.stop) == (other.iterations, other.stop)
    assert ours.levels[0].start_value == pytest.approx(theirs.levels[0].start_value, rel=1e-9)
    assert theirs.levels[1].params == tuple(theirs.warp.params)
    assert len(theirs.trace) == 12


def test_epsilon_is_named_as_the_reason(pair):
    found = run(pair, optimizer={**STAGE["optimizer"], "epsilon": 100.0}, scales=[1.0] * 4)

    assert found.stop.startswith("SimpleITK: Fnorm")
    assert found.levels[0].iterations == 0


def test_levels_of_different_lengths_run_one_after_the_other(pair):
    found = run(pair, levels=[{"shrink": 2, "iterations": 3}, {"iterations": 5}])

    assert [level.iterations for level in found.levels] == [3, 5]
    assert [(p.level, p.iteration) for p in found.trace][2:5] == [(0, 2), (1, 0), (1, 1)]
    assert any("begin anew" in note for note in found.provenance["notes"])
    assert not found.provenance["alike"]


def test_two_stages_follow_each_other(pair):
    first = {**STAGE, "transform": "translation"}
    found = regframe.register({"stages": [first, STAGE]}, *pair, engine="simpleitk")

    ours = regframe.register({"stages": [first, {**STAGE, "scales": [20.0, 20.0, 1.0, 1.0]}]}, *pair)

    assert [level.stage for level in found.levels] == [0, 0, 1, 1]
    np.testing.assert_allclose(found.levels[1].params, ours.levels[1].params, rtol=0, atol=1e-9)


def test_scales_of_the_wrong_length_are_refused(pair):
    with pytest.raises(PresetError, match="3 numbers and the transform 4"):
        run(pair, scales=[1.0, 1.0, 1.0])


def test_constant_images_are_refused(pair):
    flat = pair[1].with_values(np.full_like(pair[1].values, 3.0))

    with pytest.raises(ImageError, match="constant"):
        run((pair[0], flat))


def test_images_of_two_float_types_are_widened_and_it_is_told(pair):
    wide = pair[1].with_values(pair[1].values.astype(np.float64))

    found = run((pair[0], wide))

    assert any("float64" in note for note in found.provenance["notes"])


@pytest.mark.parametrize("metric", ["mattes", "mean-squares"])
def test_no_overlap_at_the_start_is_ours(pair, metric):
    far = Warp(Translation(), np.array([500.0, 0.0]), Frame.about_centre(pair[0].grid))

    with pytest.raises(NoOverlapError) as caught:
        run(pair, metric=metric, start=far)

    assert "\n" not in str(caught.value)


def test_losing_the_image_on_the_way_is_ours(pair):
    with pytest.raises(NoOverlapError):
        run(pair, optimizer={"type": "one-plus-one", "radius": 1e5})


def test_a_metric_without_twin_is_refused_before_the_work(pair):
    class Mine(regframe.Metric):
        def value(self, pairs):
            return 0.0

    with pytest.raises(NoTwin, match="Mine"):
        run(pair, metric=Mine())


def test_a_stage_that_needs_proof_is_refused(pair):
    stages = [STAGE, {**STAGE, "transform": "affine", "proof": 2.0}]

    with pytest.raises(NoTwin, match="Leave `proof` out"):
        regframe.register({"seed": 3, "stages": stages}, *pair, engine="simpleitk")
