"""The second engine: SimpleITK's registration method walks the same stages and levels."""

import re
from collections.abc import Generator
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, Any, final

import numpy as np

from regframe.engine.base import Engine, LevelReport, Progress, Result
from regframe.engine.native import check_images, filtered
from regframe.engine.provenance import provenance
from regframe.engine.sampling import draw
from regframe.engine.setting import Placement, Setting, begun, opened, taken_up
from regframe.engine.start import begin
from regframe.errors import NoOverlapError
from regframe.image import Image
from regframe.peer import convert, probe
from regframe.peer.faults import translated
from regframe.peer.lockstep import Teller, lockstep
from regframe.peer.method import Part, in_its_terms, parts, put, seeds_used, steady, tell_optimizer, told
from regframe.peer.twins import Terms
from regframe.preset import Preset, Stage
from regframe.transforms.warp import Chain, Warp
from regframe.types import Params

if TYPE_CHECKING:
    from regframe.peer.twins import Method

AGAIN = (
    "levels of different lengths or kinds of sampling are separate runs in SimpleITK, so the optimizer's "
    "random draws begin anew at each"
)
NO_REASON = "no reason given"
WIDENED = "one image is float32 and the other float64, which SimpleITK refuses: both are taken as float64"


@dataclass(frozen=True)
class _Seen:
    """One iteration, or the end of a level, as SimpleITK's events tell it."""

    level: int
    value: float
    params: Params
    size: float
    stop: str = ""


@final
class SimpleITKEngine(Engine):
    """Runs presets with SimpleITK's ImageRegistrationMethod.

    Filters, starts and scales in pixels of motion are regframe's; everything from there on is SimpleITK's.
    What had to be told otherwise than the preset says stands in the result's provenance under `notes`, and
    the stages as they were told under `told`.
    """

    def iterate(
        self, preset: Preset, fixed: Image, moving: Image, *, start: Warp | Chain | Placement | None = None
    ) -> Generator[Progress, None, Result]:
        """Yield a Progress an iteration and return the Result."""
        began = perf_counter()
        check_images(preset, fixed, moving)
        given = fixed, moving
        pair = convert.same_type(*filtered(preset, fixed, moving))
        run = _Run(pair, began, preset.seed)
        if fixed.values.dtype != moving.values.dtype:
            run.notes.append(WIDENED)
        place = Placement.of(start)
        setting, before = opened(place, fixed), place.start
        first: Warp | Chain | None = None
        for number, stage in enumerate(begun(preset.stages, place)):
            setting = setting.entered(stage, before)
            warp = begin(stage, *pair, before, setting)
            first = first or setting.whole(warp)
            warp = yield from run.stage(stage, number, warp, setting)
            before = warp
        facts = provenance(preset, *given, seconds=perf_counter() - began, engine="simpleitk")
        spoken = [stage.model_dump(mode="json") for stage in run.spoken]
        facts |= {"notes": list(dict.fromkeys(run.notes)), "told": spoken, "alike": run.alike}
        last, trace, found = run.reports[-1], tuple(run.trace), setting.whole(warp)
        return Result(found, last.value, last.stop, tuple(run.reports), preset, facts, *given, trace, first)


class _Run:
    """What grows while a preset is run."""

    def __init__(self, pair: tuple[Image, Image], began: float, seed: int) -> None:
        self.pair, self.began, self.seed = pair, began, seed
        self.trace: list[Progress] = []
        self.reports: list[LevelReport] = []
        self.notes: list[str] = []
        self.spoken: list[Stage] = []
        self.alike = True

    def stage(
        self, stage: Stage, number: int, warp: Warp, setting: Setting
    ) -> Generator[Progress, None, Warp]:
        """Run one stage from a warp."""
        spoken = in_its_terms(stage, warp, self.pair[1], setting)
        self.spoken.append(spoken.stage)
        self.notes += spoken.notes
        self.alike &= spoken.alike
        divided = parts(spoken, self.seed, setting)
        if spoken.draws and len(divided) > 1:
            self.notes.append(AGAIN)
            self.alike = False
        depth = 0
        for part in divided:
            ended = yield from self._walk(spoken, part, (number, depth), warp)
            for i, end in enumerate(ended):
                warp = taken_up(warp, setting, part.levels[i])
                self._report(part, (number, depth + i), i, warp, end)
                warp = Warp(warp.transform, end.params, warp.frame)
            depth += len(part.levels)
        return warp

    def _walk(
        self, spoken: Terms, part: Part, place: tuple[int, int], warp: Warp
    ) -> Generator[Progress, None, list[_Seen]]:
        """Run the levels of one call; how each ended."""
        # Refuses a start without overlap in our words, before ITK walks on with the largest double.
        _start_value(part, self.pair, taken_up(warp, part.setting, part.levels[0]))
        limit, count, level = part.levels[0].iterations, 0, 0
        ended: list[_Seen] = []
        walk: Generator[_Seen, None, None] = lockstep(
            lambda tell: _execute(spoken, part, self.pair, warp, tell)
        )
        try:
            for seen in walk:
                if seen.stop:
                    ended.append(seen)
                    count = 0
                    continue
                level, seconds = place[1] + seen.level, perf_counter() - self.began
                at = (place[0], level, count, limit)
                count += 1
                progress = Progress(*at, seen.value, seen.params, seen.size, seconds, count + 1)
                self.trace.append(progress.kept())
                yield progress
        except RuntimeError as error:
            raise translated(error) from None
        finally:
            walk.close()
        return ended

    def _report(self, part: Part, place: tuple[int, int], depth: int, start: Warp, end: _Seen) -> None:
        """Add the report of a level of a part."""
        level = part.levels[depth]
        seed = part.seed + depth * seeds_used(level)
        grid = part.setting.domain.coarsen(level.shrink)
        walked = [p for p in self.trace if (p.stage, p.level) == place]
        before = self.trace[: self.trace.index(walked[0])] if walked else self.trace
        first = _start_value(Part(part.stage, (level,), seed, part.setting), self.pair, start)
        since = before[-1].seconds if before else 0.0
        self.reports.append(
            LevelReport(
                stage=place[0],
                level=place[1],
                shape=grid.shape,
                samples=len(draw(level, grid, seed)[0]),
                iterations=len(walked),
                evaluations=len(walked) + 1,
                start_value=first,
                value=end.value if walked else first,
                stop=_reason(end.stop, level.iterations),
                seconds=(walked[-1].seconds if walked else since) - since,
                params=tuple(map(float, end.params)),
                frame=start.frame,
            )
        )


def _start_value(part: Part, pair: tuple[Image, Image], warp: Warp) -> float:
    value, _ = probe.value_and_count(part, *pair, warp)
    if not np.isfinite(value):
        message = (
            f"The images share nothing to compare at the start (metric {type(part.stage.metric).__name__}). "
            "Check the masks and geometry, or begin nearer with `start`."
        )
        raise NoOverlapError(message)
    return value


def _execute(spoken: Terms, part: Part, pair: tuple[Image, Image], warp: Warp, tell: Teller[_Seen]) -> None:
    """One call of SimpleITK, telling iterations and ends of levels."""
    import SimpleITK as sitk

    method = told(part, *pair)
    tell_optimizer(method, spoken, part.levels[0].iterations, part.seed)
    moved = put(method, part, warp, adapting=True)
    values: list[float] = []
    lowest: list[tuple[float, Params]] = []

    def iteration() -> None:
        values.append(method.GetMetricValue())
        seen = values[-1], np.array(method.GetOptimizerPosition())
        if spoken.remembers and lowest and not seen[0] < lowest[0][0]:
            seen = lowest[0]
        lowest[:] = [seen]
        if not tell(_Seen(method.GetCurrentLevel(), *seen, _size(method))):
            method.StopRegistration()

    def level_end() -> None:
        # Fires as a level begins; what the one before it left is still there.
        level, stop = method.GetCurrentLevel() - 1, method.GetOptimizerStopConditionDescription()
        if level >= 0:
            last = values[-1] if values else float("nan")
            tell(_Seen(level, last, np.array(moved.GetParameters()), 0.0, stop or NO_REASON))
            values.clear()
            lowest.clear()

    method.AddCommand(sitk.sitkIterationEvent, iteration)
    method.AddCommand(sitk.sitkMultiResolutionIterationEvent, level_end)
    with steady():
        method.Execute(*map(convert.image, pair))
    stop = method.GetOptimizerStopConditionDescription() or NO_REASON
    tell(_Seen(len(part.levels) - 1, method.GetMetricValue(), np.array(moved.GetParameters()), 0.0, stop))


def _size(method: "Method") -> float:
    """What SimpleITK tells of the length of a step: a learning rate, or the norm of a search matrix."""
    return float(method.GetOptimizerLearningRate() or method.GetOptimizerConvergenceValue())


def _reason(text: str, limit: int) -> str:
    if "Maximum number of iterations" in text:
        return f"the limit of {limit} iterations"
    return f"SimpleITK: {re.sub(r'^[A-Za-z0-9_]+: ', '', text).strip()}"


def told_preset(preset: Preset, facts: Any) -> Preset:
    """The preset as SimpleITK was told it, for the native engine to walk alike."""
    # The first stage's start may have been replaced by what was given; that is given again.
    starts = [stage.model_dump(mode="json")["start"] for stage in preset.stages]
    told = [stage | {"start": start} for stage, start in zip(facts["told"], starts, strict=True)]
    return Preset(name=preset.name, about=preset.about, seed=preset.seed, filters=preset.filters, stages=told)
