"""Our own engine: stages, levels, and the loop around the optimizer."""

from collections.abc import Generator
from time import perf_counter
from typing import final

from regframe.engine.base import Engine, LevelReport, Progress, Result
from regframe.engine.followed import followed
from regframe.engine.freedom import shown
from regframe.engine.objective import Objective
from regframe.engine.provenance import provenance
from regframe.engine.scales import coordinates
from regframe.engine.scene import Scene, prepare
from regframe.engine.setting import Placement, Setting, begun, opened, taken_up
from regframe.engine.start import begin
from regframe.errors import GeometryError, ImageError
from regframe.image import Image
from regframe.optimizers.base import Normals
from regframe.preset import Preset, Stage
from regframe.transforms.warp import Chain, Warp

SMALLEST = 4  # pixels an axis


@final
class Native(Engine):
    """Runs presets with regframe's own components."""

    def iterate(
        self, preset: Preset, fixed: Image, moving: Image, *, start: Warp | Chain | Placement | None = None
    ) -> Generator[Progress, None, Result]:
        """Yield a Progress an iteration and return the Result."""
        began = perf_counter()
        check_images(preset, fixed, moving)
        given, fixed, moving = (fixed, moving), *filtered(preset, fixed, moving)
        trace: list[Progress] = []
        reports: list[LevelReport] = []
        place = Placement.of(start)
        setting, before = opened(place, fixed), place.start
        first: Warp | Chain | None = None
        for number, stage in enumerate(begun(preset.stages, place)):
            setting = setting.entered(stage, before)
            warp = begin(stage, fixed, moving, before, setting)
            first = first or setting.whole(warp)
            rng, seed = stage.optimizer.normals(preset.seed), preset.seed
            for depth in range(len(stage.levels)):
                run = _Level(stage, setting, (number, depth), seed)
                warp, report = yield from run.walk((fixed, moving), warp, rng, trace, began)
                seed = run.next_seed
                reports.append(report)
            before = warp
        facts = provenance(preset, *given, seconds=perf_counter() - began)
        last, found = reports[-1], setting.whole(warp)
        return Result(
            found, last.value, last.stop, tuple(reports), preset, facts, *given, tuple(trace), first
        )


class _Level:
    """One level of a run."""

    def __init__(self, stage: Stage, setting: Setting, place: tuple[int, int], seed: int) -> None:
        self.stage, self.setting = followed(stage, setting.beyond), setting
        self.number, self.depth = place
        self.level = stage.levels[self.depth]
        self.seed = self.next_seed = seed

    def walk(
        self, images: tuple[Image, Image], warp: Warp, rng: Normals, trace: list[Progress], began: float
    ) -> Generator[Progress, None, tuple[Warp, LevelReport]]:
        """Improve a warp until the optimizer or the limit stops it."""
        level_began = perf_counter()
        warp = taken_up(warp, self.setting, self.level)
        scene, self.next_seed = prepare(self.stage, self.level, *images, self.seed, self.setting)
        space, at = coordinates(self.stage, warp.params, warp.frame, scene.grid, images[1].grid)
        objective = Objective(self.stage, scene, warp.frame, space)
        problem = shown(objective, self.stage, at, space.free)
        steps = self.stage.optimizer.steps(problem, at[problem.free], rng)
        limit, before = self.level.iterations, len(trace)
        stop = f"the limit of {limit} iterations"
        for count in range(limit):
            try:
                step = next(steps)
            except StopIteration as end:
                stop = str(end.value)
                break
            at = problem.whole(step.params)
            place, seconds = (self.number, self.depth, count, limit), perf_counter() - began
            here = objective.settled(at)
            progress = Progress(*place, step.value, here, step.size, seconds, objective.evaluations)
            trace.append(progress.kept())
            yield progress
        steps.close()
        found = Warp(warp.transform, objective.settled(at), warp.frame)
        return found, self.report(
            scene, objective, found, trace[before:], (stop, perf_counter() - level_began)
        )

    def report(
        self,
        scene: Scene,
        objective: Objective,
        found: Warp,
        walked: list[Progress],
        end: tuple[str, float],
    ) -> LevelReport:
        """What the level did, from its steps, its stop reason and its seconds."""
        stop, seconds = end
        return LevelReport(
            stage=self.number,
            level=self.depth,
            shape=scene.grid.shape,
            samples=len(scene.samples),
            iterations=len(walked),
            evaluations=objective.evaluations,
            start_value=objective.first,
            value=walked[-1].value if walked else objective.first,
            stop=stop,
            seconds=seconds,
            params=tuple(map(float, found.params)),
            frame=found.frame,
        )


def filtered(preset: Preset, fixed: Image, moving: Image) -> tuple[Image, Image]:
    """Both images after the preset's filters, checked for contrast."""
    for one in preset.filters.fixed:
        fixed = one(fixed)
    for one in preset.filters.moving:
        moving = one(moving)
    for image in (fixed, moving):
        low, high = image.range()
        if low == high:
            where = "under its mask" if image.mask is not None else "everywhere"
            message = f"{image.name}: the image is constant, {low:g} {where}. There is nothing to align."
            raise ImageError(message)
    return fixed, moving


def check_images(preset: Preset, fixed: Image, moving: Image) -> None:
    """Refuse pairs that no preset, or not this one, can register.

    Raises
    ------
    GeometryError, ImageError
    """
    if fixed.dim != moving.dim:
        message = (
            f"{fixed.name} is {fixed.dim}-D and {moving.name} is {moving.dim}-D. Both must have the same "
            "number of axes; take a slice of the larger one."
        )
        raise GeometryError(message)
    for image in (fixed, moving):
        if min(image.grid.shape) < SMALLEST:
            message = (
                f"{image.name}: an image of shape {image.grid.shape} is too small to register. "
                f"Every axis needs at least {SMALLEST} pixels."
            )
            raise ImageError(message)
    for number, stage in enumerate(preset.stages):
        if fixed.dim not in stage.transform.dimensions:
            known = " and ".join(f"{dim}-D" for dim in stage.transform.dimensions)
            message = (
                f"stages.{number}.transform: {type(stage.transform).__name__} is for {known} images. "
                f"Got {fixed.dim}-D. Choose another transform, such as affine."
            )
            raise GeometryError(message)
