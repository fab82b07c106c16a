"""``regframe register``: align one image to another."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from regframe.cli import plugin_files
from regframe.cli.inputs import Domain, FixedInitial, MovingInitial, Start
from regframe.cli.plugin_files import Plugins

if TYPE_CHECKING:
    from regframe.preset import Preset

Fixed = Annotated[
    Path, typer.Argument(metavar="FIXED", help="The image that stays, for instance the visual frame.")
]
Moving = Annotated[
    Path,
    typer.Argument(
        metavar="MOVING", help="The image that is brought onto it, for instance the thermal frame."
    ),
]
Out = Annotated[
    Path | None, typer.Option("--out", "-o", help="Folder for everything found; made if missing.")
]
PresetName = Annotated[
    str, typer.Option("--preset", "-p", help="Name (regframe list presets) or a .toml file.")
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="PATH=VALUE", help="Change one value of the preset, e.g. stages.0.metric.bins=32."
    ),
]
Seed = Annotated[int | None, typer.Option(help="The preset's seed: same seed, same result.")]
FixedMask = Annotated[Path | None, typer.Option(help="Image that is not 0 where fixed pixels count.")]
MovingMask = Annotated[Path | None, typer.Option(help="Image that is not 0 where moving pixels count.")]
EngineName = Annotated[str, typer.Option(help="Who runs the preset: native, or simpleitk.")]
Threads = Annotated[int | None, typer.Option(min=1, help="Threads to use; the result does not depend on it.")]
NoFigures = Annotated[bool, typer.Option("--no-figures", help="Write no overlays and plots.")]
NoVerdict = Annotated[
    bool, typer.Option("--no-verdict", help="Do not judge the result; saves up to half of the time.")
]
KeepFailed = Annotated[
    bool,
    typer.Option(
        "--keep-failed", help="Write image and transform of a failed registration too, and end with code 0."
    ),
]
Force = Annotated[bool, typer.Option("--force", "-f", help="Replace an earlier result in the folder.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print only the outcome.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print the outcome as JSON, and nothing else.")]


def register(
    fixed: Fixed,
    moving: Moving,
    preset: PresetName = "visual-thermal",
    out: Out = None,
    settings: Settings = None,
    seed: Seed = None,
    start: Start = None,
    moving_initial: MovingInitial = None,
    fixed_initial: FixedInitial = None,
    domain: Domain = None,
    fixed_mask: FixedMask = None,
    moving_mask: MovingMask = None,
    engine: EngineName = "native",
    threads: Threads = None,
    no_figures: NoFigures = False,
    no_verdict: NoVerdict = False,
    keep_failed: KeepFailed = False,
    plugin: Plugins = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: AsJson = False,
) -> None:
    """Align MOVING to FIXED, judge the result, write the aligned image, the transform and pictures.

    The code is 1 when the verdict is "failed"; image and transform are withheld then, unless --keep-failed.
    """
    _use(threads, plugin)
    # Everything that can be refused is refused before the work begins.
    _check(out, force)
    from regframe.cli import inputs
    from regframe.cli.display import Display, manner
    from regframe.cli.outcome import Outcome
    from regframe.engine.run import register as align_pair

    resolved = resolve(preset, settings or [], seed, engine)
    known = inputs.Files(start, moving_initial, fixed_initial, domain)
    below, above, place = inputs.everything(fixed, moving, (fixed_mask, moving_mask), known)
    with Display(resolved, manner(quiet or as_json)) as display:
        result = align_pair(resolved, below, above, engine=engine, observers=(display,), start=place)
        display.note("judging the result ...")
        outcome = Outcome.of(result, out, verdict=not no_verdict, keep_failed=keep_failed)
    outcome.save(force=force, figures=not no_figures)
    raise typer.Exit(outcome.tell("json" if as_json else "line" if quiet else "full"))


def _use(threads: int | None, plugin: Plugins) -> None:
    if threads is not None:
        os.environ["REGFRAME_THREADS"] = str(threads)
    plugin_files.use(plugin)


def _check(out: Path | None, force: bool) -> None:
    from regframe.report import files

    if out is not None:
        files.check(out, force=force)


def resolve(name: str, settings: list[str], seed: int | None, engine: str) -> "Preset":
    """The preset with the command line's changes, and an engine that exists."""
    from regframe.engine.run import ENGINES
    from regframe.errors import PresetError
    from regframe.faults import nearest
    from regframe.preset import load, setting

    if engine not in ENGINES:
        message = f"no engine is called {engine!r}.{nearest(engine, ENGINES)} Known: {', '.join(ENGINES)}."
        raise PresetError(message)
    changes = dict(map(setting, settings))
    if seed is not None:
        changes["seed"] = seed
    return load(name, changes)
