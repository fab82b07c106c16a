"""The first floor: each part by itself, the same question put to both engines."""

from collections.abc import Callable, Iterator

import numpy as np

from regframe.engine.scene import smoothed
from regframe.errors import NoOverlapError, RegframeError
from regframe.interpolators.base import Samples
from regframe.peer import probe, twins
from regframe.peer.bench import Bench
from regframe.peer.report import Floor, Line, Sweep, incomparable, largest, measured
from regframe.types import Indices, Params

FLOOR: Floor = "components"
SLOPES = "docs/explanation/agreement.md#slopes"
MANY = 500
"""Random points at which maps and interpolators are compared."""


def compare(bench: Bench, title: str) -> tuple[list[Line], list[Sweep]]:
    """Lines of all components of a stage, and its sweeps; `title` names the stage where there are many."""
    questions: list[tuple[str, Callable[[Bench, str], Line]]] = [
        ("points mapped by the transform", transform),
        ("interpolated values", interpolation),
        ("samples that count", count),
        ("slope of the metric", slope),
    ]
    lines = [*smoothing(bench, title)]
    lines += [attempted(FLOOR, title + what, ask, bench) for what, ask in questions]
    sweeps: list[Sweep] = []
    try:
        for sweep in swept(bench):
            sweeps.append(sweep)
            lines.append(along(bench, sweep, title))
    except RegframeError as error:
        lines.append(incomparable(FLOOR, f"{title}metric along each parameter", str(error)))
    return lines, sweeps


def attempted(floor: Floor, what: str, ask: Callable[[Bench, str], Line], bench: Bench) -> Line:
    """A line, or why there is none: a missing twin, or a refusal of SimpleITK's."""
    try:
        return ask(bench, what)
    except RegframeError as error:
        return incomparable(floor, what, str(error))


def smoothing(bench: Bench, title: str) -> Iterator[Line]:
    """Each level's smoothed images, as a share of their range."""
    for number, level in enumerate(bench.stage.levels):
        if level.smooth == 0.0:
            continue
        apart = []
        for image in (bench.fixed, bench.moving):
            low, high = image.range()
            how = image, level.smooth, bench.stage.smooth_unit
            ours, theirs = smoothed(*how), probe.smoothed(*how)
            apart.append(float(np.abs(ours.values - theirs.values).max()) / (high - low))
        what = f"{title}images smoothed for level {number + 1}"
        # Both sides keep intermediate results in single precision.
        yield measured(FLOOR, what, largest(apart), 1e-6, "of the range")


def transform(bench: Bench, what: str) -> Line:
    """Where random points go, at the answer and around it."""
    rng = np.random.default_rng(1)
    grid, unit = bench.setting.domain, bench.unit
    indices = rng.uniform(-0.5, np.array(grid.shape) - 0.5, (MANY, grid.dim))
    points, apart = grid.points(indices), []
    for size in (0.0, 1.0, 10.0):
        moved = rng.normal(size=len(unit)) * size / np.where(unit > 0, unit, 1.0)
        warp = bench.onward(bench.warp.params + moved)
        apart.append(float(np.abs(warp(points) - probe.mapped(warp, points)).max()))
    return measured(FLOOR, what, largest(apart), 1e-9, unit_of(bench))


def interpolation(bench: Bench, what: str) -> Line:
    """Values of the moving image at random places, the outer half pixel included."""
    image, way = bench.moving, bench.stage.interpolator
    indices = _random_places(image.grid.shape)
    coefficients = way.prepare(np.ascontiguousarray(image.values, np.float64))
    ours, inside = way.resample(coefficients, Samples(image.grid.shape, indices), None)
    theirs = probe.at_points(image, image.grid.points(indices), twins.interpolator(way))
    both = (inside > 0) & np.isfinite(theirs)
    low, high = image.range()
    apart = np.abs(ours[both] - theirs[both]) / (high - low)
    if not np.array_equal(inside > 0, np.isfinite(theirs)):
        apart = np.append(apart, np.inf)
    # The Gaussian interpolator rests on ITK's own error function, good to nine digits.
    return measured(FLOOR, what, largest(apart), 1e-7, "of the range")


def count(bench: Bench, what: str) -> Line:
    """How many samples each metric counts at the answer."""
    ours = twins.counted(bench.stage.metric, bench.objective.pairs(bench.warp.params))
    _, theirs = probe.value_and_count(bench.part, *bench.theirs, bench.warp)
    why = f"{theirs} in SimpleITK, {ours} in regframe"
    return measured(FLOOR, what, abs(ours - theirs), 0, "samples", why=why)


def slope(bench: Bench, what: str) -> Line:
    """The metric's slope by each pixel of motion, with ITK's gradient of the moving image."""
    params, metric = bench.warp.params, bench.objective.stage.metric
    theirs = probe.derivative(bench.part, *bench.theirs, bench.warp)
    if metric.derivative(bench.objective.pairs(params)) is None:
        why = f"{type(metric).__name__} has no `derivative`, so ours are differences of values; see {SLOPES}"
        return incomparable(FLOOR, what, why)
    unit = bench.unit
    _, ours = bench.objective.value_and_gradient(params)
    steepest = float(np.abs(theirs / unit).max()) or 1.0
    apart = np.abs((ours - theirs) / unit) / steepest
    worst = bench.warp.transform.names(bench.warp.frame)[int(np.argmax(apart))]
    return measured(
        FLOOR, what, largest(apart), precision(bench), "of the steepest", why=f"the largest by {worst}"
    )


def swept(bench: Bench) -> Iterator[Sweep]:
    """Both metrics along some parameters."""
    for name, motions, positions in bench.swept():
        ours = [float(value) for value in bench.objective.values(np.array(positions))]
        theirs = [_their_value(bench, params) for params in positions]
        yield Sweep(name, tuple(map(float, motions)), tuple(ours), tuple(theirs))


def along(bench: Bench, sweep: Sweep, title: str) -> Line:
    """The line of a sweep: its largest difference, as a share of the largest value."""
    ours, theirs = np.array(sweep.native), np.array(sweep.simpleitk)
    what = f"{title}metric along {sweep.name}"
    return measured(FLOOR, what, relative(ours, theirs), precision(bench), "of the value")


def relative(ours: Params, theirs: Params) -> float:
    """Largest difference as a share of the largest value; equal infinities agree."""
    known = np.isfinite(ours) & np.isfinite(theirs)
    if not np.array_equal(ours[~known], theirs[~known]):
        return float("inf")
    if not known.any():
        return 0.0
    size = float(np.abs(theirs[known]).max()) or 1.0
    return largest(np.abs(ours[known] - theirs[known]) / size)


def precision(bench: Bench) -> float:
    """How well values must agree: float32 images are rounded at places where regframe need not."""
    return 1e-7 if bench.single else 1e-9


def unit_of(bench: Bench) -> str:
    """``px`` for camera frames, else ``mm``."""
    grid = bench.fixed.grid
    return "px" if grid == type(grid).of_shape(grid.shape) else "mm"


def _their_value(bench: Bench, params: Params) -> float:
    try:
        return probe.value(bench.part, *bench.theirs, bench.at(params))
    except NoOverlapError:
        return float("inf")


def _random_places(shape: tuple[int, ...]) -> Indices:
    """Random indices of an image, a tenth of them in its outer half pixel."""
    rng = np.random.default_rng(2)
    last = np.array(shape) - 0.5
    inner = rng.uniform(-0.5, last, (MANY, len(shape)))
    edge = rng.uniform(-0.499, -0.001, (MANY // 10, len(shape)))
    inner[: len(edge), -1] = edge[:, -1]
    return inner
