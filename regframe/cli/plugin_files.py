"""``--plugin``: files of the user's own, and those that the user's configuration lists."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from regframe.plugins import Configuration, Loaded

Plugins = Annotated[
    list[Path] | None,
    typer.Option(
        "--plugin",
        metavar="FILE.py",
        help="Run a Python file of yours and use its components by name; may be given again.",
    ),
]


def use(named: Sequence[Path] | None) -> None:
    """Load the files of the configuration and of the command line; tell faults and go on."""
    from regframe.cli.inputs import existing

    for path in named or ():
        existing(path, "plugin")
    settings, loaded = load(named)
    for text in (*settings.faults, *(fault for each in loaded for fault in each.faults)):
        typer.secho(f"regframe: {text}", err=True, fg=typer.colors.RED)


def load(named: Sequence[Path] | None) -> "tuple[Configuration, list[Loaded]]":
    """The user's configuration, and what came of every file, each loaded once."""
    from regframe import plugins

    settings = plugins.configuration()
    paths = {path.expanduser().resolve(): path for path in (*settings.files, *(named or ()))}
    return settings, [plugins.load(path) for path in paths.values()]
