"""The standing report: how far each component and its twin agree, measured, as a table of the documents."""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from inspect import cleandoc
from math import ceil, log10
from typing import Any

import numpy as np

from regframe.catalog import INTERPOLATORS, METRICS, OPTIMIZERS, TRANSFORMS
from regframe.component import Component
from regframe.engine.setting import Setting
from regframe.errors import NoTwin, RegframeError
from regframe.geometry import Frame, Grid
from regframe.image import Image
from regframe.metrics.base import Metric
from regframe.peer import components, probe, twins, whole
from regframe.peer.bench import Bench
from regframe.peer.report import largest
from regframe.preset import Level, Preset, Stage
from regframe.transforms.warp import Warp

HEAD = "| component | SimpleITK's | compared by | within | how it relates to ITK's |\n|---|---|---|---|---|"
OPTIONS: Mapping[str, Mapping[str, Any]] = {
    "exhaustive": {"number_of_steps": [1]},
    "sum": {"parts": ["mattes", "correlation"]},
}
"""What is set for the measurement: a lattice that fits into the level's iterations, and what must be."""
VARIANTS: Mapping[str, tuple[Mapping[str, Any], ...]] = {
    "interpolators/bspline": tuple({"order": order} for order in range(6)),
    "interpolators/windowed-sinc": tuple(
        {"window": window} for window in ("blackman", "cosine", "hamming", "lanczos", "welch")
    ),
    "transforms/bspline": ({"order": 2, "mesh": (3,)}, {"order": 3, "mesh": (5,)}),
}
"""Components that are several of SimpleITK's: all of these are compared, and the worst is told."""
LEVEL = Level(shrink=2, smooth=1.0, iterations=100)
NONE = "none"
SAME = "The same."


@dataclass(frozen=True)
class Row:
    """One component's line in the table."""

    name: str
    twin: str
    way: str
    within: float | None
    unit: str
    relation: str

    def text(self) -> str:
        """The line in Markdown."""
        return f"| `{self.name}` | {self.twin} | {self.way} | {self.bound()} | {self.relation} |"

    def bound(self) -> str:
        """The difference rounded up to a power of ten, which other machines keep too."""
        if self.within is None:
            return "not compared"
        return f"{bound(self.within):.0e} {self.unit}" if self.within else "equal bits"


def bound(difference: float) -> float:
    """The next power of ten above a difference.

    Examples
    --------
    >>> bound(3e-13), bound(0.0)
    (1e-12, 0.0)
    """
    return float(10.0 ** ceil(log10(difference))) if difference > 0 else 0.0


def table(more: Mapping[str, list[Row]] | None = None) -> str:
    """All components that regframe ships, by kind, and further sections."""
    parts = []
    for kind, rows in {**sections(), **(more or {})}.items():
        parts += [f"### {kind.capitalize()}\n", HEAD, *(row.text() for row in rows), ""]
    return "\n".join(parts)


def sections() -> dict[str, list[Row]]:
    """Measured rows of each kind."""
    kinds: dict[str, tuple[Any, Callable[[Any], tuple[str, float, str]], Callable[[Any], str]]] = {
        "metrics": (METRICS, _metric, lambda ours: _called(lambda m: twins.metric(ours, m))),
        "transforms": (TRANSFORMS, _transform, _class_of),
        "interpolators": (INTERPOLATORS, _interpolator, lambda ours: f"`{twins.interpolator(ours)}`"),
        "optimizers": (
            OPTIMIZERS,
            _optimizer,
            lambda ours: _called(lambda m: twins.optimizer(ours, m, 1, 1)),
        ),
    }
    found: dict[str, list[Row]] = {}
    for kind, (registry, measure, theirs) in kinds.items():
        shipped = [name for name in registry.names() if registry.origin(name) == "regframe"]
        for name in shipped:
            every = VARIANTS.get(f"{kind}/{name}", (OPTIONS.get(name, {}),))
            made = [registry.build({"type": name, **options}) for options in every]
            found.setdefault(kind, []).append(_worst([_row(name, ours, measure, theirs) for ours in made]))
    return found


def _worst(rows: list[Row]) -> Row:
    """One line of all variants of a component."""
    twins_of = ", ".join(dict.fromkeys(row.twin for row in rows))
    known = [row.within for row in rows if row.within is not None]
    return replace(rows[-1], twin=twins_of, within=largest(known) if known else None)


def _row(
    name: str, ours: Component, measure: Callable[[Any], tuple[str, float, str]], theirs: Callable[[Any], str]
) -> Row:
    relation = _relation(ours)
    try:
        twin = theirs(ours)
    except NoTwin:
        return Row(name, NONE, "pairs only", None, "", "Has no twin." if relation == SAME else relation)
    try:
        way, within, unit = measure(ours)
    except RegframeError as error:
        return Row(name, twin, f"not on the phantoms: {error}", None, "", relation)
    return Row(name, twin, way, within, unit, relation)


def _relation(ours: Component) -> str:
    """What the class says of ITK: the sentences of its docstring that name it."""
    text = " ".join(cleandoc(ours.__doc__ or "").split())
    sentences = re.split(r"(?<=[.;]) (?=[A-Z`])", text)
    told = " ".join(one for one in sentences if "ITK" in one or "itk::" in one).rstrip(";.")
    return f"{told}.".replace("|", "\\|") if told else SAME


class _Recorder:
    """Stands for a registration method and remembers which setters were called."""

    def __init__(self) -> None:
        self.called: list[str] = []

    def __getattr__(self, name: str) -> Callable[..., None]:
        return lambda *_, **__: self.called.append(name)


def _called(tell: Callable[[Any], None]) -> str:
    recorder = _Recorder()
    tell(recorder)
    return ", ".join(f"`{name}`" for name in recorder.called)


def _class_of(ours: Any) -> str:
    frames = (Frame.about_centre(Grid.of_shape((8,) * dim)) for dim in ours.dimensions)
    return ", ".join(dict.fromkeys(f"`{twins.transform(ours, frame).GetName()}`" for frame in frames))


def _metric(ours: Any) -> tuple[str, float, str]:
    if type(ours).forces is not Metric.forces:
        return _pushes(ours)
    bench = _bench(_dim2(), metric=ours)
    sweeps = list(components.swept(bench))
    apart = [components.along(bench, sweep, "").difference for sweep in sweeps]
    slope = components.slope(bench, "")
    way = "values along sweeps" if slope.difference is None else "values along sweeps, slope"
    return way, largest(one for one in (*apart, slope.difference) if one is not None), "relative"


def _pushes(ours: Any) -> tuple[str, float, str]:
    level = LEVEL.model_copy(update={"shrink": 1})  # a field has its points on the fixed image's grid
    apart: list[float] = []
    for pair in (_dim2(), _dim3()):
        bench = _bench(pair, metric=ours, transform="translation", levels=(level,))
        value, pushes = probe.pushed(bench.part, *bench.theirs, bench.warp)
        pairs = bench.objective.pairs(bench.warp.params)
        found = bench.objective.forces(pairs)
        assert found is not None
        apart.append(float(np.abs(found - pushes).max() / np.abs(pushes).max()))
        apart.append(abs(ours.value(pairs) - value) / abs(value))
    return "value and pushes on a displacement field, 2-D and 3-D", largest(apart), "relative"


def _transform(ours: Any) -> tuple[str, float, str]:
    pairs = {2: _dim2, 3: _dim3}
    benches = [_bench(pairs[dim](), transform=ours) for dim in ours.dimensions]
    apart = [components.transform(bench, "").difference for bench in benches]
    dims = " and ".join(f"{dim}-D" for dim in ours.dimensions)
    return f"mapped points, {dims}", largest(one for one in apart if one is not None), "px"


def _interpolator(ours: Any) -> tuple[str, float, str]:
    benches = (
        _bench(pair(), transform=TRANSFORMS.build("translation"), interpolator=ours)
        for pair in (_dim2, _dim3)
    )
    apart = [components.interpolation(bench, "").difference for bench in benches]
    return (
        "values at random points, 2-D and 3-D",
        largest(one for one in apart if one is not None),
        "of the range",
    )


def _optimizer(ours: Any) -> tuple[str, float, str]:
    stage = _stage(optimizer=ours)
    runs = whole.run(Preset(stages=(stage,)), *_dim2())
    if runs.simpleitk is None:
        raise RegframeError(runs.refusal)
    way = "whole run" if runs.alike else "answers only: the walks are not alike"
    return way, whole.apart(runs.native.warp, runs.simpleitk.warp), "px"


def _stage(**changes: Any) -> Stage:
    parts = {
        "transform": "similarity",
        "interpolator": "linear",
        "metric": "mean-squares",
        "optimizer": "one-plus-one",
    }
    return Stage(**{**parts, "levels": (LEVEL,), **changes})


def _bench(pair: tuple[Image, Image], **changes: Any) -> Bench:
    fixed, moving = pair
    stage = _stage(**changes)
    frame = Frame.about_centre(fixed.grid)
    params = stage.transform.identity(frame)
    off = np.random.default_rng(4).normal(size=len(params)) / stage.transform.shift(params, frame)
    return Bench(stage, 1, fixed, moving, Warp(stage.transform, params + off, frame), Setting(fixed.grid))


def _dim2() -> tuple[Image, Image]:
    return waves((40, 48))


def _dim3() -> tuple[Image, Image]:
    return waves((14, 16, 18))


def waves(shape: tuple[int, ...]) -> tuple[Image, Image]:
    """Two sums of waves, alike but for a shift and a shade; float64, so that nothing is rounded."""
    places = np.indices(shape, dtype=np.float64)

    def value(shift: float) -> "np.ndarray[Any, np.dtype[np.float64]]":
        along = sum(np.sin((0.21 + 0.09 * axis) * (place - shift)) for axis, place in enumerate(places))
        return np.asarray(100.0 + 30.0 * along + 10.0 * np.cos(0.13 * (places[0] - shift) * places[-1] / 9.0))

    grid = Grid.of_shape(shape)
    return Image(value(0.0), grid, name="fixed"), Image(value(0.8) + 2.0, grid, name="moving")


def rows() -> Iterator[Row]:
    """Every row, measured now."""
    for found in sections().values():
        yield from found
