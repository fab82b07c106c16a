"""``regframe crosscheck``: a preset on a pair, held against SimpleITK."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from regframe.cli import plugin_files
from regframe.cli.inputs import Domain, FixedInitial, MovingInitial, Start
from regframe.cli.plugin_files import Plugins

if TYPE_CHECKING:
    from regframe.peer.report import Report

PresetName = Annotated[
    str, typer.Argument(metavar="PRESET", help="Name (regframe list presets) or a .toml file.")
]
Fixed = Annotated[Path, typer.Argument(metavar="FIXED", help="The image that stays.")]
Moving = Annotated[Path, typer.Argument(metavar="MOVING", help="The image that is brought onto it.")]
Out = Annotated[
    Path | None, typer.Option("--out", "-o", help="Folder for the page, its figure and the numbers.")
]
FailAbove = Annotated[
    float | None,
    typer.Option(
        metavar="PX",
        min=0.0,
        help="Exit with 1 if answers are farther apart at a corner (pixels, or mm), or if a part differs.",
    ),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="PATH=VALUE", help="Change one value of the preset, e.g. stages.0.metric.bins=32."
    ),
]
Seed = Annotated[int | None, typer.Option(help="The preset's seed.")]
FixedMask = Annotated[Path | None, typer.Option(help="Image that is not 0 where fixed pixels count.")]
MovingMask = Annotated[Path | None, typer.Option(help="Image that is not 0 where moving pixels count.")]
Force = Annotated[bool, typer.Option("--force", "-f", help="Replace an earlier report in the folder.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print only the verdict.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print the report as JSON, and nothing else.")]

DIFFERS = 1


def crosscheck(
    preset: PresetName,
    fixed: Fixed,
    moving: Moving,
    out: Out = None,
    fail_above: FailAbove = None,
    settings: Settings = None,
    seed: Seed = None,
    start: Start = None,
    moving_initial: MovingInitial = None,
    fixed_initial: FixedInitial = None,
    domain: Domain = None,
    fixed_mask: FixedMask = None,
    moving_mask: MovingMask = None,
    plugin: Plugins = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: AsJson = False,
) -> None:
    """Run PRESET with regframe and with SimpleITK, and tell part by part how far they agree."""
    from regframe.cli import inputs
    from regframe.cli.display import Display, manner
    from regframe.cli.register import resolve
    from regframe.peer.crosscheck import crosscheck as check_pair
    from regframe.peer.page import check

    plugin_files.use(plugin)
    if out is not None:
        check(out, force=force)
    resolved = resolve(preset, settings or [], seed, "simpleitk")
    known = inputs.Files(start, moving_initial, fixed_initial, domain)
    below, above, place = inputs.everything(fixed, moving, (fixed_mask, moving_mask), known)
    with Display(resolved, "none" if quiet or as_json else manner(False)) as display:
        report = check_pair(resolved, below, above, observers=(display,), start=place)
    if out is not None:
        report.save(out, force=force)
    tell(report, out, quiet=quiet, as_json=as_json)
    if fail_above is not None and report.fails(fail_above):
        raise typer.Exit(DIFFERS)


def tell(report: "Report", out: Path | None, *, quiet: bool, as_json: bool) -> None:
    """Print the report: tables by floor, only the verdict when quiet, or JSON."""
    if as_json:
        from regframe.report.records import to_json

        typer.echo(to_json(report.record()))
        return
    if not quiet:
        _tables(report)
    typer.secho(report.verdict(), fg=typer.colors.GREEN if report.agrees else typer.colors.RED, bold=True)
    if out is not None:
        typer.echo(f"Open {out / 'crosscheck.html'} in a browser.")
    elif not quiet:
        typer.echo("Nothing was written. Add --out FOLDER for a page with the curves.")


def _tables(report: "Report") -> None:
    from regframe.cli.tables import table
    from regframe.peer.report import FLOORS

    said: set[str] = set()
    for floor, told in FLOORS.items():
        typer.echo(f"{typer.style(floor, bold=True)} ({told})")
        rows = []
        for line in report.lines:
            if line.floor == floor:
                # One missing twin is the reason of several lines.
                rows.append((line.what, line.told(), "as above" if line.why in said else line.why))
                said |= {line.why} - {""}
        table(("compared", "verdict", "what else"), rows)
        typer.echo()
    for note in report.notes:
        typer.echo(f"note: {note}")
