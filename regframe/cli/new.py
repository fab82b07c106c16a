"""``regframe new``: a plugin to begin with."""

from pathlib import Path
from typing import Annotated

import typer

from regframe.cli import plugin_files

Kind = Annotated[
    str, typer.Argument(metavar="KIND", help="metric, transform, interpolator, optimizer or filter.")
]
Name = Annotated[str, typer.Argument(metavar="NAME", help="What presets will call it, like my-metric.")]
Out = Annotated[Path | None, typer.Option("--out", "-o", help="Folder to make; else NAME, here.")]
Force = Annotated[bool, typer.Option("--force", "-f", help="Replace the plugin's files in a folder.")]


def new(kind: Kind, name: Name, out: Out = None, force: Force = False) -> None:
    """Make a distribution with one component that works: source, preset, tests, pyproject, README."""
    from regframe.cli.scaffold import plugin, write

    plugin_files.use(None)  # so that names in the user's configuration count as taken
    files = plugin(kind, name)
    folder = out or Path(name)
    write(files, folder, force=force)
    for file in files:
        typer.echo(f"wrote {folder / file}")
    source = next(file for file in files if file.endswith("__init__.py"))
    typer.echo("\nIt works as it is. Next:")
    for words, why in (
        (f"pip install -e {folder}", "once; regframe then knows it by name"),
        (f"edit {folder / source}", "make it yours"),
        (f"regframe check {kind.removesuffix('s')} {name}", "every claim such a component must hold"),
    ):
        typer.echo(f"  {words:{4 + len(str(folder / source)) + 6}}  {why}")
