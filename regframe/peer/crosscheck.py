"""One call from a preset and two images to a report on how far both engines agree."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from regframe.engine.base import Observer, Result
from regframe.engine.native import check_images, filtered
from regframe.engine.provenance import versions
from regframe.engine.run import as_preset
from regframe.engine.setting import Placement
from regframe.errors import RegframeError
from regframe.io import coerce
from regframe.peer import components, convert, pairs, probe, whole
from regframe.peer.bench import Bench
from regframe.peer.components import precision, relative, unit_of
from regframe.peer.report import Line, Report, Sweep, measured
from regframe.preset import Preset
from regframe.transforms.warp import Chain, Warp


def crosscheck(
    preset: Preset | str | Path | Mapping[str, Any],
    fixed: Any,
    moving: Any,
    *,
    observers: Iterable[Observer] = (),
    start: Warp | Chain | Placement | None = None,
) -> Report:
    """Hold regframe against SimpleITK on one pair of images: by parts, by pairs and by whole runs.

    Parameters
    ----------
    preset : Preset, name, path or mapping
        Its stages, components and levels are what is compared.
    fixed, moving : path, numpy array, SimpleITK image or Image
    observers : callables
        Each is called with a Progress after every iteration of SimpleITK's run, the longest part.
    start : Warp, Chain or Placement, optional
        As for `register`.

    Returns
    -------
    Report

    Raises
    ------
    RegframeError
        The preset or an image is faulty, or the native engine cannot run them. What SimpleITK cannot do
        is told in the report.

    Examples
    --------
    >>> from regframe.testing.phantoms import visual_thermal
    >>> pair = visual_thermal(seed=1, shape=(48, 64))
    >>> report = crosscheck({"extends": "paper-similarity", "stages.0.levels.0.iterations": 5},
    ...                     pair.fixed, pair.moving)
    >>> report.agrees, report.corner < 1e-9
    (True, True)
    """
    resolved = as_preset(preset)
    given = coerce(fixed, "fixed"), coerce(moving, "moving")
    check_images(resolved, *given)
    below, above = convert.same_type(*filtered(resolved, *given))
    # Both engines get images of one float type, so that they round alike.
    ready = resolved.model_copy(update={"filters": type(resolved.filters)()})
    place = Placement.of(start)
    runs = whole.run(ready, below, above, tuple(observers), place)
    found = whole.answers(runs.native, (below, above), place)
    lines: list[Line] = []
    sweeps: list[Sweep] = []
    benches = [
        Bench(stage, resolved.seed, below, above, *answer)
        for stage, answer in zip(runs.native.preset.stages, found, strict=True)
    ]
    for number, bench in enumerate(benches):
        title = f"stage {number + 1}: " if len(benches) > 1 else ""
        more, curves = components.compare(bench, title)
        lines += [*more, *pairs.compare(bench, title)]
        sweeps += curves
    lines.sort(key=lambda line: line.floor)
    return _report(resolved, given, runs, benches, (lines, sweeps))


def _report(
    preset: Preset,
    given: tuple[Any, Any],
    runs: whole.Runs,
    benches: list[Bench],
    parts: tuple[list[Line], list[Sweep]],
) -> Report:
    lines, sweeps = parts
    unit = unit_of(benches[-1])
    walked, course = whole.compare(runs, [bench.warp for bench in benches], unit)
    scores = _scores(runs, benches[-1])
    if len(scores) > 1:
        values = np.array([list(row.values()) for row in scores.values()])
        apart = relative(values[:, 0], values[:, 1])
        what = "each answer's score by both metrics"
        walked.append(measured("whole run", what, apart, precision(benches[-1]), "of the value"))
    notes = () if runs.simpleitk is None else tuple(runs.simpleitk.provenance["notes"])
    if runs.written is not None:
        far = whole.apart(runs.written.warp, runs.native.warp)
        notes += (f"run as it is written, by the native engine, the preset ends {far:.2g} {unit} from there",)
    return Report(
        preset,
        given[0].name,
        given[1].name,
        unit,
        (*lines, *walked),
        tuple(sweeps),
        course,
        None if runs.simpleitk is None else whole.apart(runs.native.warp, runs.simpleitk.warp),
        scores,
        {name: one.seconds for name, one in _named(runs).items()},
        notes,
        versions(),
    )


def _named(runs: whole.Runs) -> dict[str, Result]:
    return {"native": runs.native} | ({} if runs.simpleitk is None else {"simpleitk": runs.simpleitk})


def _scores(runs: whole.Runs, bench: Bench) -> dict[str, dict[str, float]]:
    """Value of each answer by each metric, on the last level."""
    found = {}
    for name, result in _named(runs).items():
        params = np.array(result.levels[-1].params)
        values = {"native": float(bench.objective.values(params[None])[0])}
        try:
            values["simpleitk"] = probe.value(bench.part, *bench.theirs, bench.at(params))
        except RegframeError:
            return {}
        found[name] = values
    return found
