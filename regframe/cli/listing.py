"""``regframe list``: what there is, in a line each."""

import re
from typing import Annotated

import typer

from regframe.cli import plugin_files
from regframe.cli.plugin_files import Plugins

PLURALS = ("metrics", "transforms", "interpolators", "optimizers", "filters", "presets")

KindName = Annotated[
    str | None, typer.Argument(metavar="[KIND]", help=f"One of {', '.join(PLURALS)}; all when left out.")
]


def show(kind: KindName = None, plugin: Plugins = None) -> None:
    """List metrics, transforms, interpolators, optimizers, filters and presets, plugins included."""
    from regframe.cli.tables import table
    from regframe.errors import PresetError
    from regframe.faults import nearest

    plugin_files.use(plugin)
    if kind is not None and kind not in PLURALS:
        message = f"nothing is listed under {kind!r}.{nearest(kind, PLURALS)} Known: {', '.join(PLURALS)}."
        raise PresetError(message)
    if kind is not None:
        table(("name", "what it is", "origin"), rows(kind))
        return
    for number, one in enumerate(PLURALS):
        if number:
            typer.echo()
        typer.secho(one, bold=True)
        table(("name", "what it is", "origin"), rows(one))


def rows(kind: str) -> list[tuple[str, str, str]]:
    """Name, one-line summary and origin of every member of a kind, in its plural."""
    if kind == "presets":
        return _presets()
    from regframe.catalog import KINDS
    from regframe.errors import PresetError

    registry, found = KINDS[kind], []
    for name in registry.names():
        try:
            text = first_line(registry[name].__doc__)
        except PresetError as error:
            # One broken plugin must not hide the others.
            text = f"unusable: {error}"
        found.append((name, text, registry.origin(name)))
    return found


def first_line(text: str | None) -> str:
    """The first line of a docstring, without its marks of code."""
    return (text or "").strip().partition("\n")[0].replace("`", "")


def first_sentence(text: str) -> str:
    """A text up to its first full stop after a whole word.

    Examples
    --------
    >>> first_sentence("The model of J. Doe. No pyramid.")
    'The model of J. Doe.'
    """
    whole = " ".join(text.split())
    found = re.search(r"(?<=[a-z0-9)\]\"'])\. ", whole)
    return whole if found is None else f"{whole[: found.start()]}."


def _presets() -> list[tuple[str, str, str]]:
    from regframe.errors import PresetError
    from regframe.preset import load, names, origin

    found = []
    for name in names():
        try:
            text = first_sentence(load(name).about)
        except PresetError as error:
            # One broken plugin must not hide the others.
            text = f"unusable: {' '.join(str(error).split())}"
        found.append((name, text, origin(name)))
    return found
