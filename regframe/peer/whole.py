"""The third floor: both engines run the preset from the same start and seed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from regframe.engine.base import Engine, Observer, Progress, Result
from regframe.engine.native import Native
from regframe.engine.setting import Placement, Setting, begun, opened
from regframe.engine.start import begin
from regframe.errors import NoTwin, RegframeError
from regframe.image import Image
from regframe.peer.report import Course, Floor, Line, incomparable, largest, measured
from regframe.peer.simpleitk import SimpleITKEngine, told_preset
from regframe.preset import Preset
from regframe.transforms.warp import Chain, Warp

FLOOR: Floor = "whole run"
WALKED = 1e-4
"""Pixels (or mm) between answers of equal walks that still agree."""
REACHED = 0.1
"""The same between answers of searches that go their own ways to them."""


@dataclass(frozen=True)
class Runs:
    """The runs of both engines, or why SimpleITK made none.

    Parameters
    ----------
    native : Result
        Of the preset as SimpleITK was told it; of the preset itself where SimpleITK could not run it.
    simpleitk : Result, optional
    written : Result, optional
        Of the preset as it is written, by the native engine, where that is another one.
    refusal : str
    """

    native: Result
    simpleitk: Result | None
    written: Result | None
    refusal: str

    @property
    def alike(self) -> bool:
        """Whether both walked, or should have walked, the same way."""
        return self.simpleitk is not None and bool(self.simpleitk.provenance["alike"])


def run(
    preset: Preset,
    fixed: Image,
    moving: Image,
    observers: Sequence[Observer] = (),
    place: Placement | None = None,
) -> Runs:
    """Run a preset with both engines; observers watch SimpleITK's run, which takes longest.

    Raises
    ------
    RegframeError
        The native engine cannot run it.
    """

    def native(one: Preset) -> Result:
        return finished(Native(), one, (fixed, moving), (), place)

    try:
        theirs = finished(SimpleITKEngine(), preset, (fixed, moving), observers, place)
    except NoTwin as error:
        return Runs(native(preset), None, None, str(error))
    except RegframeError as error:
        return Runs(native(preset), None, None, f"SimpleITK's run failed: {error}")
    told = told_preset(preset, theirs.provenance)
    ours = native(told)
    if told.stages == preset.stages:
        return Runs(ours, theirs, None, "")
    return Runs(ours, theirs, native(preset), "")


def finished(
    engine: Engine,
    preset: Preset,
    pair: tuple[Image, Image],
    observers: Sequence[Observer] = (),
    place: Placement | None = None,
) -> Result:
    """The result of a whole run."""
    steps = engine.iterate(preset, *pair, start=place)
    while True:
        try:
            progress = next(steps)
        except StopIteration as end:
            result: Result = end.value
            return result
        for observer in observers:
            observer(progress)


def answers(
    result: Result, pair: tuple[Image, Image], place: Placement | None = None
) -> list[tuple[Warp, Setting]]:
    """The map that each stage ended with, and its setting; `pair` are the images after their filters."""
    place = place or Placement()
    setting, before = opened(place, pair[0]), place.start
    found: list[tuple[Warp, Setting]] = []
    for number, stage in enumerate(begun(result.preset.stages, place)):
        setting = setting.entered(stage, before)
        warp = begin(stage, *pair, before, setting)
        last = [level for level in result.levels if level.stage == number][-1]
        before = Warp(warp.transform, np.array(last.params), last.frame)
        found.append((before, setting))
    return found


def apart(one: Warp | Chain, other: Warp | Chain) -> float:
    """Largest distance between two maps over the fixed image's corners, in physical units."""
    corners = one.frame.grid.corners()
    return largest(np.sqrt(((one(corners) - other(corners)) ** 2).sum(axis=1)))


def compare(runs: Runs, frames: Sequence[Warp], unit: str) -> tuple[list[Line], Course | None]:
    """Lines of the whole run, and both courses; `frames` are the answers of the stages."""
    if runs.simpleitk is None:
        return [incomparable(FLOOR, "both engines from the same start", runs.refusal)], None
    course = _course(runs.native, runs.simpleitk, frames)
    kept = not any(np.isnan(far) for far in course.apart)
    bound = WALKED if runs.alike else REACHED
    ends = apart(runs.native.warp, runs.simpleitk.warp)
    lines = [measured(FLOOR, "corners of the fixed image under both answers", ends, bound, unit)]
    if not kept:
        why = "the steps of so many parameters are not kept"
        lines.append(incomparable(FLOOR, "corners along the way, at each iteration", why))
    elif runs.alike:
        counts = f"{len(runs.native.trace)} and {len(runs.simpleitk.trace)} iterations"
        same = len(runs.native.trace) == len(runs.simpleitk.trace)
        way = largest(course.apart) if same else float("inf")
        lines.append(
            measured(FLOOR, "corners along the way, at each iteration", way, bound, unit, why=counts)
        )
    else:
        why = f"{'; '.join(runs.simpleitk.provenance['notes'])}; see {SAID_OTHERWISE}"
        lines.append(incomparable(FLOOR, "corners along the way, at each iteration", why))
    lines.append(_stops(runs))
    return lines, course


SAID_OTHERWISE = "docs/explanation/agreement.md#said-otherwise"


def _stops(runs: Runs) -> Line:
    """Iterations of each level, with both reasons where they are not the same."""
    what = "iterations of each level"
    ours, theirs = runs.native.levels, () if runs.simpleitk is None else runs.simpleitk.levels
    pairs = list(zip(ours, theirs, strict=True))
    reasons = {one.stop if one.stop == other.stop else f"{one.stop}; {other.stop}" for one, other in pairs}
    why = " | ".join(sorted(reasons))
    if not runs.alike:
        return incomparable(FLOOR, what, why)
    gap = max(abs(one.iterations - other.iterations) for one, other in pairs)
    # SimpleITK tells nobody of a step in the very iteration that stops.
    return measured(FLOOR, what, gap, 1, "iterations", why=why)


def _course(ours: Result, theirs: Result, frames: Sequence[Warp]) -> Course:
    both = list(zip(ours.trace, theirs.trace, strict=False))
    levels = {
        (one.stage, one.level): Warp(frames[one.stage].transform, frames[one.stage].params, one.frame)
        for one in ours.levels
    }
    begins = [i for i, (step, _) in enumerate(both) if step.iteration == 0]
    return Course(
        tuple(float(step.value) for step in ours.trace),
        tuple(float(step.value) for step in theirs.trace),
        tuple(_distance(one, other, levels) for one, other in both),
        tuple(begins),
    )


def _distance(one: Progress, other: Progress, levels: Mapping[tuple[int, int], Warp]) -> float:
    place = (one.stage, one.level)
    if place != (other.stage, other.level) or len(one.params) != len(other.params):
        return float("inf")
    if not len(one.params):
        return float("nan")
    frame = levels[place]
    first, second = (Warp(frame.transform, step.params, frame.frame) for step in (one, other))
    return apart(first, second)
