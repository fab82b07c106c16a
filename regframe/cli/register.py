"""``regframe register``: align one image to another."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from regframe.cli import plugin_files
from regframe.cli.inputs import Domain, FixedInitial, MovingInitial, Start
from regframe.cli.plugin_files import Plugins

if TYPE_CHECKING:
    from regframe.engine.base import Result
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
Force = Annotated[bool, typer.Option("--force", "-f", help="Replace an earlier result in the folder.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print only the outcome.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print the outcome as JSON, and nothing else.")]


def register(
    fixed: Fixed,
    moving: Moving,
    preset: PresetName = "paper-similarity",
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
    plugin: Plugins = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: AsJson = False,
) -> None:
    """Align MOVING to FIXED and write the aligned image, the transform and pictures."""
    if threads is not None:
        os.environ["REGFRAME_THREADS"] = str(threads)
    from regframe.cli import inputs
    from regframe.cli.display import Display, manner
    from regframe.engine.run import register as align_pair
    from regframe.report import files

    plugin_files.use(plugin)
    # Everything that can be refused is refused before the work begins.
    if out is not None:
        files.check(out, force=force)
    resolved = resolve(preset, settings or [], seed, engine)
    known = inputs.Files(start, moving_initial, fixed_initial, domain)
    below, above, place = inputs.everything(fixed, moving, (fixed_mask, moving_mask), known)
    with Display(resolved, manner(quiet or as_json)) as display:
        result = align_pair(resolved, below, above, engine=engine, observers=(display,), start=place)
    if out is not None:
        files.save(result, out, force=force, figures=not no_figures)
    tell(result, out, quiet=quiet, as_json=as_json)


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


def tell(result: "Result", out: Path | None, *, quiet: bool, as_json: bool) -> None:
    """Print the outcome: a table of facts, one line when quiet, or JSON."""
    from regframe.report import html, records

    if as_json:
        record = {**records.result_record(result), "transform": records.transform_record(result)}
        typer.echo(records.to_json(record))
        return
    facts = dict(html.facts(result))
    if quiet:
        place = "" if out is None else f"; wrote {out}"
        typer.echo(f"{facts['map']}; value {result.value:.6g}; {facts['effort']}{place}")
        return
    for name, text in facts.items():
        _line(name, text)
    if out is None:
        typer.echo("Nothing was written. Add --out FOLDER for the aligned image, the transform and pictures.")
        return
    from regframe.report.files import earlier

    names = earlier(out)
    _line("wrote", f"{len(names)} files in {out}")
    if "overlay-red-cyan.png" in names:
        typer.echo(f"Look at {out / 'overlay-red-cyan.png'} next to {out / 'overlay-before.png'}.")


def _line(name: str, text: str) -> None:
    typer.echo(typer.style(f"{name:11}", bold=True) + text)
