"""Ratios against SimpleITK in one run: 640 x 512, all pixels, 50 bins, two threads each.

``pytest -m slow tests/benchmarks -s`` prints the table. Both sides are timed in turn, so that a machine
whose speed drifts slows both, and medians are compared. The targets are for two idle cores; a test fails
below half of its target, because a busy neighbour takes the second core from us more than from SimpleITK.
"""

import statistics
from collections.abc import Callable
from time import perf_counter

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.catalog import TRANSFORMS
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.objectives import objective

pytestmark = pytest.mark.slow

SHAPE = (512, 640)
ROUNDS = 7


def theirs_ms(interpolator: str, *, derivative: bool) -> Callable[[], float]:
    """Milliseconds a SimpleITK evaluation inside a run, where nothing is set up anew."""
    fixed, moving = peer.pair(SHAPE)
    stills = peer.image(fixed), peer.image(moving)

    def measure() -> float:
        run = peer.method(fixed, moving, interpolator)
        run.SetNumberOfThreads(2)
        run.SetInitialTransform(peer.transform(warp_of(fixed)), False)
        if derivative:
            run.SetOptimizerAsGradientDescent(1e-9, 8, -1e300, 100, run.Never)
        else:
            run.SetOptimizerAsOnePlusOneEvolutionary(8, 1e-300, 1e-3, seed=3)
        ticks: list[float] = []
        run.AddCommand(sitk.sitkIterationEvent, lambda: ticks.append(perf_counter()))
        run.Execute(*stills)
        return 1e3 * statistics.median(np.diff(ticks))

    return measure


def ours_ms(interpolator: str, *, derivative: bool) -> Callable[[], float]:
    """Milliseconds of our evaluation, medians of as many calls."""
    fixed, moving = peer.pair(SHAPE)
    warp = warp_of(fixed)
    ready = objective(fixed, moving, warp, interpolator)
    call = (
        (lambda: ready.value_and_gradient(warp.params))
        if derivative
        else (lambda: ready.values(warp.params[None]))
    )
    call()

    def measure() -> float:
        spans = []
        for _ in range(8):
            began = perf_counter()
            call()
            spans.append(perf_counter() - began)
        return 1e3 * statistics.median(spans)

    return measure


def warp_of(fixed):
    return Warp(TRANSFORMS.build("similarity"), np.array([1.02, 0.03, 3.3, -2.2]), peer.frame(fixed))


@pytest.mark.parametrize(
    ("interpolator", "derivative", "target"),
    [("bspline3", False, 16.0), ("linear", False, 10.0), ("bspline3", True, 12.0)],
    ids=["value-bspline", "value-linear", "derivative-bspline"],
)
def test_mattes_is_faster_by(interpolator, derivative, target, monkeypatch, capsys):
    monkeypatch.setenv("REGFRAME_THREADS", "2")
    sides = [side(interpolator, derivative=derivative) for side in (theirs_ms, ours_ms)]

    rounds = [[side() for side in sides] for _ in range(ROUNDS)]

    theirs, ours = (statistics.median(column) for column in zip(*rounds, strict=True))
    ratio = statistics.median(a / b for a, b in rounds)
    what = "value and derivative" if derivative else "value"
    times = f"{theirs:.1f} ms / {ours:.2f} ms"
    with capsys.disabled():
        print(f"\nMattes {what}, {interpolator}: {times} = {ratio:.1f}x, target {target:.0f}x")
    assert ratio >= target / 2
