"""``regframe preset``: look at presets, check them, compare them."""

from typing import Annotated

import typer

from regframe.cli import plugin_files
from regframe.cli.plugin_files import Plugins

Name = Annotated[str, typer.Argument(metavar="NAME-OR-FILE", help="A shipped preset's name or a .toml file.")]
Settings = Annotated[
    list[str] | None, typer.Option("--set", metavar="PATH=VALUE", help="Change one value, e.g. seed=7.")
]

WIDEST = 72

app = typer.Typer(help="Look at presets, check them, compare them.", no_args_is_help=False)


@app.command("show")
def show(name: Name, settings: Settings = None, plugin: Plugins = None) -> None:
    """Print a preset as TOML, every default written out."""
    from regframe.preset import as_toml, load, setting

    plugin_files.use(plugin)
    preset = load(name, dict(map(setting, settings or [])))
    typer.echo(as_toml(preset).rstrip())


@app.command("validate")
def validate(name: Name, plugin: Plugins = None) -> None:
    """Check a preset; faults are told one a line, each with its path."""
    from regframe.preset import load

    plugin_files.use(plugin)
    preset = load(name)
    levels = sum(len(stage.levels) for stage in preset.stages)
    words = (_count(len(preset.stages), "stage"), _count(levels, "level"))
    typer.echo(f"{preset.name} is valid: {', '.join(words)}.")


@app.command("schema")
def schema(plugin: Plugins = None) -> None:
    """Print the JSON schema of presets, for editors that check and complete TOML."""
    import json

    from regframe.preset import schema as make

    plugin_files.use(plugin)
    typer.echo(json.dumps(make(), indent=2))


@app.command("diff")
def diff(first: Name, second: Name, plugin: Plugins = None) -> None:
    """List what differs between two presets: path, first value, second value."""
    from regframe.cli.tables import table
    from regframe.preset import differences, load

    plugin_files.use(plugin)
    found = differences(load(first), load(second))
    if not found:
        typer.echo("no difference")
        return
    table(("path", first, second), [(path, _short(old), _short(new)) for path, old, new in found])


def _short(value: object) -> str:
    from regframe.cli.explain import toml

    text = "-" if value is None else toml(value)
    return text if len(text) <= WIDEST else f"{text[: WIDEST - 3]}..."


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
