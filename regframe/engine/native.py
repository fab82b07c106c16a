"""Our own engine: stages, levels, and the loop around the optimizer."""

from collections.abc import Generator, Mapping
from dataclasses import replace
from time import perf_counter
from typing import Any, TypeVar, cast, final

from regframe.engine.averaging import Pyramid, fitted
from regframe.engine.base import Engine, LevelReport, Progress, Result
from regframe.engine.candidate import Candidate, Place
from regframe.engine.carried import CarriedObjective
from regframe.engine.choice import Choice
from regframe.engine.followed import followed
from regframe.engine.freedom import shown
from regframe.engine.keeping import chosen, held_out_gains
from regframe.engine.objective import Objective
from regframe.engine.overlap import shares
from regframe.engine.provenance import provenance
from regframe.engine.scales import Coordinates, coordinates
from regframe.engine.scene import Scene, prepare
from regframe.engine.search import search, within
from regframe.engine.setting import Placement, Setting, begun, opened, taken_up
from regframe.engine.start import begin
from regframe.errors import GeometryError, ImageError
from regframe.image import Image
from regframe.kernels.sharing import share
from regframe.optimizers.base import Normals, Step
from regframe.preset import Preset, Search, Stage
from regframe.transforms.warp import Chain, Warp
from regframe.types import Params

T = TypeVar("T")

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
        run = _Run(Pyramid(*filtered(preset, fixed, moving)), began)
        warp, first = yield from run.stages(preset, Placement.of(start))
        facts = provenance(preset, fixed, moving, seconds=perf_counter() - began)
        return run.result(warp, preset, facts, (fixed, moving), first)


def found(preset: Preset, fixed: Image, moving: Image) -> Warp | Chain:
    """The map that a preset finds, and nothing of how."""
    check_images(preset, fixed, moving)
    run = _Run(Pyramid(*filtered(preset, fixed, moving)), perf_counter())
    return exhausted(run.stages(preset, Placement.of(None)))[0]


def searched(stage: Stage, pyramid: Pyramid, warp: Warp, setting: Setting) -> tuple[Place, ...]:
    """Where a stage's first level begins: one place, or those that a search found."""
    if isinstance(stage.start, Search):
        return search(stage, pyramid, setting)
    return (Place(warp, warp),)


class _Run:
    """What grows while a preset is run."""

    def __init__(self, pyramid: Pyramid, began: float) -> None:
        self.pyramid, self.began = pyramid, began
        self.trace: list[Progress] = []
        self.reports: list[LevelReport] = []
        self.candidates: tuple[Candidate, ...] = ()
        self.choices: list[Choice] = []
        self.last: LevelReport | None = None

    def stages(
        self, preset: Preset, place: Placement
    ) -> Generator[Progress, None, tuple[Warp | Chain, Warp | Chain | None]]:
        """Walk all stages; the whole map found, and the one it began from."""
        fixed, moving = self.pyramid.images
        setting, before = opened(place, fixed), place.start
        first: Warp | Chain | None = None
        for number, stage in enumerate(begun(preset.stages, place)):
            setting = setting.entered(stage, before)
            warp = begin(stage, fixed, moving, before, setting)
            first = first or setting.whole(warp)
            rng, seed = stage.optimizer.normals(preset.seed), preset.seed
            places = searched(stage, self.pyramid, warp, setting)
            for depth in range(len(stage.levels)):
                level = _Level(stage, setting, (number, depth), seed)
                places = yield from self.level(level, places, rng)
                seed = level.next_seed
            simpler, warp = warp, places[0].found
            if not self.earned(_Trial(stage, setting, number, preset.seed), simpler):
                warp = before if isinstance(before, Warp) else simpler
            before = warp
        return setting.whole(warp), first

    def earned(self, trial: "_Trial", simpler: Warp) -> bool:
        """Whether the stage's map stays; asked of stages that need proof."""
        if trial.stage.proof is not None:
            self.choices.append(trial.choice(self.pyramid, simpler))
        kept = trial.stage.proof is None or self.choices[-1].kept
        self.last = self.reports[-1] if kept or self.last is None else self.last
        return kept

    def level(
        self, level: "_Level", places: tuple[Place, ...], rng: Normals
    ) -> Generator[Progress, None, tuple[Place, ...]]:
        """Walk a level from the best places; all of them, those that were walked before others, by value."""
        going = places[: level.kept]
        if len(going) == 1:
            trace: list[Progress] = []
            rng = rng if level.level.optimizer is None else level.stage.optimizer.normals(level.seed)
            steps = level.walk(self.pyramid, going[0].found, rng, trace, self.began, 0)
            warp, report = yield from steps
            walked = [(level.ended(self.pyramid, going[0], warp, report), report, trace)]
        else:
            walked = self.side_by_side(level, going)
            for _, _, trace in walked:
                yield from trace
        walked.sort(key=lambda one: one[0].rank(level.stage.metric))
        others = sum(report.evaluations for _, report, _ in walked[1:])
        self.reports.append(replace(walked[0][1], places=len(walked), other_evaluations=others))
        self.trace += walked[0][2]
        ranked = (*(one for one, _, _ in walked), *places[level.kept :])
        if isinstance(level.start, Search):
            self.candidates = tuple(one.candidate(level.setting) for one in ranked)
        return ranked

    def side_by_side(
        self, level: "_Level", going: tuple[Place, ...]
    ) -> list[tuple[Place, LevelReport, list[Progress]]]:
        """Walk a level from several places, each with deviates of its own, so that threads may share them."""
        walked: list[tuple[Place, LevelReport, list[Progress]] | None] = [None] * len(going)
        level.ready(self.pyramid, going)

        def walk(first: int, last: int) -> None:
            for i in range(first, last):
                trace: list[Progress] = []
                rng = level.stage.optimizer.normals(level.seed + i)
                end = exhausted(level.walk(self.pyramid, going[i].found, rng, trace, self.began, i))
                walked[i] = (level.ended(self.pyramid, going[i], *end), end[1], trace)

        share(walk, len(going))
        return [one for one in walked if one is not None]

    def result(
        self,
        warp: Warp | Chain,
        preset: Preset,
        facts: Mapping[str, Any],
        given: tuple[Image, Image],
        first: Warp | Chain | None,
    ) -> Result:
        """What was found."""
        last = self.last or self.reports[-1]
        seen = (tuple(self.reports), preset, facts, *given, tuple(self.trace))
        return Result(warp, last.value, last.stop, *seen, first, self.candidates, tuple(self.choices))


class _Level:
    """One level of a run."""

    def __init__(self, stage: Stage, setting: Setting, place: tuple[int, int], seed: int) -> None:
        self.number, self.depth = place
        self.level = stage.levels[self.depth]
        if self.level.optimizer is not None:
            stage = stage.model_copy(update={"optimizer": self.level.optimizer})
        self.stage, self.setting = followed(stage, setting.beyond), setting
        self.seed = self.next_seed = seed

    @property
    def start(self) -> str | Search:
        """Where the stage began."""
        return self.stage.start

    @property
    def kept(self) -> int:
        """How many places the level is walked from."""
        start = self.stage.start
        return start.keep[self.depth] if isinstance(start, Search) and self.depth < len(start.keep) else 1

    def walk(
        self,
        pyramid: Pyramid,
        warp: Warp,
        rng: Normals,
        trace: list[Progress],
        began: float,
        candidate: int,
    ) -> Generator[Progress, None, tuple[Warp, LevelReport]]:
        """Improve a warp until the optimizer or the limit stops it."""
        level_began = perf_counter()
        warp = taken_up(warp, self.setting, self.level)
        scene, self.next_seed = self.scene(pyramid, warp)
        space, at = coordinates(self.stage, warp.params, warp.frame, scene.grid, pyramid.images[1].grid)
        objective = self.objective(scene, warp, space)
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
            progress = self.progress(step, objective, at, count, perf_counter() - began, candidate)
            trace.append(progress.kept())
            yield progress
        steps.close()
        found = Warp(warp.transform, objective.settled(at), warp.frame)
        values = objective.first, trace[-1].value if len(trace) > before else objective.first
        if self.level.carried and self.kept == 1:
            # Carried values serve to compare places; of the only one the metric itself is told.
            values = objective.measured(warp.params), objective.measured(found.params)
        done = len(trace) - before, objective.evaluations, stop, perf_counter() - level_began
        return found, self.report(scene, found, values, done)

    def objective(self, scene: Scene, warp: Warp, space: Coordinates) -> Objective:
        """What is made small, about a warp."""
        if self.level.carried:
            return CarriedObjective(self.stage, scene, warp.frame, space, warp.params)
        return Objective(self.stage, scene, warp.frame, space)

    def ended(self, pyramid: Pyramid, place: Place, warp: Warp, report: LevelReport) -> Place:
        """A place after its walk, which may have led a search's place astray."""
        place, start = place.walked(warp, report.value), self.start
        if not isinstance(start, Search):
            return place
        whole, (fixed, moving) = self.setting.whole(warp), (image.grid for image in pyramid.images)
        return place.met_anew(shares(whole, fixed, moving), within=within(start, whole, fixed, moving))

    def ready(self, pyramid: Pyramid, places: tuple[Place, ...]) -> None:
        """Average what the places need, before threads ask for it."""
        if self.level.fit is not None:
            for place in places:
                fitted(pyramid, self.setting, self.setting.onward(place.found), self.level.fit)

    def scene(self, pyramid: Pyramid, warp: Warp) -> tuple[Scene, int]:
        """The level's scene, and the sampling seed of the next level."""
        images, setting = pyramid.images, self.setting
        if self.level.fit is not None:
            images, setting = fitted(pyramid, setting, setting.onward(warp), self.level.fit)
        return prepare(self.stage, self.level, *images, self.seed, setting)

    def progress(
        self, step: Step, objective: Objective, at: Params, count: int, seconds: float, candidate: int
    ) -> Progress:
        """An iteration as observers see it."""
        place = (self.number, self.depth, count, self.level.iterations)
        done = (step.size, seconds, objective.evaluations, candidate)
        return Progress(*place, step.value, objective.settled(at), *done)

    def report(
        self, scene: Scene, found: Warp, values: tuple[float, float], done: tuple[int, int, str, float]
    ) -> LevelReport:
        """What the level did: its values, first and last, and iterations, evaluations, stop, seconds."""
        iterations, evaluations, stop, seconds = done
        return LevelReport(
            stage=self.number,
            level=self.depth,
            shape=scene.grid.shape,
            samples=len(scene.samples),
            iterations=iterations,
            evaluations=evaluations,
            start_value=values[0],
            value=values[1],
            stop=stop,
            seconds=seconds,
            params=tuple(map(float, found.params)),
            frame=found.frame,
        )


class _Trial:
    """A stage fitted again on parts of the image, to judge it on the others."""

    def __init__(self, stage: Stage, setting: Setting, number: int, seed: int) -> None:
        self.stage, self.setting, self.number, self.seed = stage, setting, number, seed

    def choice(self, pyramid: Pyramid, simpler: Warp) -> Choice:
        """Whether the stage's map earns its keep over the one that it began from."""
        fixed, moving = pyramid.images
        last = _Level(self.stage, self.setting, (self.number, len(self.stage.levels) - 1), self.seed)
        scene, _ = last.scene(pyramid, simpler)
        space, _ = coordinates(last.stage, simpler.params, simpler.frame, scene.grid, moving.grid)
        whole = Objective(last.stage, scene, simpler.frame, space)
        gains = held_out_gains(
            lambda part: self.fitted(Pyramid(part, moving), simpler), fixed, whole, simpler.params
        )
        return chosen(self.number, gains, self.stage.proof or 0.0)

    def fitted(self, pyramid: Pyramid, warp: Warp) -> Warp:
        """Where the stage ends with other images."""
        rng, seed = self.stage.optimizer.normals(self.seed), self.seed
        for depth in range(len(self.stage.levels)):
            level = _Level(self.stage, self.setting, (self.number, depth), seed)
            warp, _ = exhausted(level.walk(pyramid, warp, rng, [], 0.0, 0))
            seed = level.next_seed
        return warp


def exhausted(steps: Generator[Progress, None, T]) -> T:
    """What a walk ends with, its progress unseen."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return cast("T", end.value)


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
