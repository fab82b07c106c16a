"""``regframe demo``: the main job on a built-in pair whose answer is known."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from regframe.cli import plugin_files
from regframe.cli.plugin_files import Plugins

if TYPE_CHECKING:
    from regframe.testing.phantoms import Phantom

FOLDER = "regframe-demo"
PRESET = "visual-thermal"
PAIR = ("visual.png", "thermal.png")

Out = Annotated[
    Path | None, typer.Option("--out", "-o", help=f"Folder to write; else the first free {FOLDER}.")
]
PresetName = Annotated[str, typer.Option("--preset", "-p", help="Another preset to try.")]
Seed = Annotated[int, typer.Option(min=0, help="Another scene, seen by cameras mounted otherwise.")]
Force = Annotated[bool, typer.Option("--force", "-f", help="Replace an earlier result in the folder.")]


def demo(
    out: Out = None,
    preset: PresetName = PRESET,
    seed: Seed = 1,
    plugin: Plugins = None,
    force: Force = False,
) -> None:
    """Align a built-in visual and thermal frame, print the true error and the verdict, write the pictures."""
    from regframe.cli.display import Display, manner
    from regframe.engine.run import register
    from regframe.preset import load
    from regframe.report import files
    from regframe.report.starts import first_warp
    from regframe.testing.phantoms import corner_error, visual_thermal

    plugin_files.use(plugin)
    folder = out or _free()
    files.check(folder, force=force)
    _check_pair(folder, force)
    resolved = load(preset)
    pair = visual_thermal(seed)
    (ny, nx), (thermal_ny, thermal_nx) = pair.fixed.grid.shape, pair.moving.grid.shape
    typer.echo(
        f"A street seen by two cameras: visual {nx}x{ny}, 8 bit; thermal {thermal_nx}x{thermal_ny}, 16 bit."
    )
    typer.echo(f"Which thermal pixel belongs to which visual pixel? Preset {resolved.name} searches.")
    typer.echo("A first run also compiles what it needs, which takes some twenty seconds; later ones do not.")
    with Display(resolved, manner(quiet=False)) as display:
        result = register(resolved, pair.fixed, pair.moving, observers=(display,))
    files.save(result, folder, force=force, keep_failed=True)
    _write_pair(pair, folder, force)
    before, after = (
        corner_error(warp, pair.truth, pair.fixed.grid) for warp in (first_warp(result), result.warp)
    )
    typer.echo(f"\ncorner error before  {before:7.2f} thermal px")
    typer.secho(f"corner error after   {after:7.2f} thermal px, in {result.seconds:.1f} s", bold=True)
    typer.echo(f"verdict                 {result.verdict.summary()}")
    typer.echo("                        (from the images alone, without the true answer)")
    _next_steps(folder)


def _free() -> Path:
    """The first folder of the demo's name that is not taken."""
    number, folder = 1, Path(FOLDER)
    while folder.exists():
        number += 1
        folder = Path(f"{FOLDER}-{number}")
    return folder


def _check_pair(folder: Path, force: bool) -> None:
    from regframe.io import refuse_existing

    for name in PAIR:
        refuse_existing(folder / name, force)


def _write_pair(pair: "Phantom", folder: Path, force: bool) -> None:
    from regframe.io import write

    for image, name in zip((pair.fixed, pair.moving), PAIR, strict=True):
        pixels = image.values if image.raw is None else image.raw
        write(pixels, image.grid, folder / name, force=force)


def _next_steps(folder: Path) -> None:
    visual, thermal = (folder / name for name in PAIR)
    typer.echo(f"\nPictures are in {folder}. Look first at:")
    typer.echo(f"  {folder / 'overlay-before.png'}     visual red, thermal cyan, as the cameras gave them")
    typer.echo(f"  {folder / 'overlay-red-cyan.png'}   the same after registration: edges coincide")
    typer.echo(f"  {folder / 'convergence.png'}        how the search went")
    typer.echo("\nTry next:")
    typer.echo(f"  regframe register {visual} {thermal} --out my-first")
    typer.echo(f"  regframe apply {folder / 'transform.tfm'} {thermal} --like {visual} --out aligned.png")
    typer.echo("  regframe list")
