"""``regframe explain``: one component or preset, with all its options."""

import inspect
from typing import TYPE_CHECKING, Annotated, Any

import typer

from regframe.cli import plugin_files
from regframe.cli.plugin_files import Plugins

if TYPE_CHECKING:
    from regframe.component import Component
    from regframe.preset import Level

Name = Annotated[str, typer.Argument(help="A component's or a preset's name, or a preset file.")]

EXAMPLES = {
    "metrics": "metric = {}",
    "transforms": "transform = {}",
    "interpolators": "interpolator = {}",
    "optimizers": "optimizer = {}",
    "filters": "filters.moving = [{}]",
}
LIMITS = {"minimum": ">= {}", "exclusiveMinimum": "> {}", "maximum": "<= {}", "exclusiveMaximum": "< {}"}


def explain(name: Name, plugin: Plugins = None) -> None:
    """Tell what a component or preset does, its options, defaults and ranges, and how to write it."""
    from regframe.catalog import KINDS
    from regframe.errors import PresetError
    from regframe.faults import nearest
    from regframe.preset import names

    plugin_files.use(plugin)
    kinds = [kind for kind, registry in KINDS.items() if name in registry.names()]
    for number, kind in enumerate(kinds):
        if number:
            typer.echo()
        _component(kind, name)
    if name in names() or name.endswith(".toml"):
        _preset(name)
    elif not kinds:
        known = sorted({*names(), *(one for registry in KINDS.values() for one in registry.names())})
        message = f"nothing is called {name!r}.{nearest(name, known)} See regframe list."
        raise PresetError(message)


def options(cls: "type[Component]") -> list[tuple[str, str, str, str, str]]:
    """Name, type, default, range and description of every field of a component."""
    schema = cls.model_json_schema()
    required = schema.get("required", [])
    found = []
    for name, field in schema.get("properties", {}).items():
        default = "required" if name in required else toml(field.get("default"))
        found.append((name, _type(field), default, _range(field), field.get("description", "")))
    return found


def example(kind: str, name: str, cls: "type[Component]") -> str:
    """A line of a preset that names the component and writes its options out."""
    pairs = [
        (option, "..." if default == "required" else default) for option, _, default, _, _ in options(cls)
    ]
    written = ", ".join(f"{option} = {value}" for option, value in pairs if value != "none")
    whole = f'{{type = "{name}", {written}}}' if written else f'"{name}"'
    return EXAMPLES[kind].format(whole)


def toml(value: object) -> str:
    """A value as a preset would write it; ``none`` where it cannot.

    Examples
    --------
    >>> toml({"type": "mattes", "bins": 50})
    '{type = "mattes", bins = 50}'
    """
    if value is None:
        return "none"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml, value))}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {toml(one)}' for key, one in value.items())}}}"
    return str(value)


def _component(kind: str, name: str) -> None:
    from regframe.catalog import KINDS
    from regframe.cli.tables import table

    registry = KINDS[kind]
    cls = registry[name]
    typer.echo(f"{typer.style(name, bold=True)} ({registry.kind}, from {registry.origin(name)})\n")
    typer.echo(inspect.cleandoc(cls.__doc__ or "No description.").replace("`", ""))
    if kind == "transforms":
        _parameters(cls)
    rows = options(cls)
    typer.echo()
    if rows:
        table(("option", "type", "default", "range", "meaning"), rows)
    else:
        typer.echo("It has no options.")
    typer.echo(f"\nIn a preset:\n  {example(kind, name, cls)}")


def _parameters(cls: "type[Any]") -> None:
    from regframe.geometry import Frame, Grid

    for dim in cls.dimensions:
        names = cls().names(Frame.about_centre(Grid.of_shape((2,) * dim)))
        typer.echo(f"\nParameters in {dim}-D: {', '.join(names)}")


def _level(level: "Level") -> str:
    """Its iterations and size, in a few words."""
    from regframe.catalog import OPTIMIZERS

    own = f" by {OPTIMIZERS.name_of(level.optimizer)}" if level.optimizer is not None else ""
    carried = " (carried)" if level.carried else ""
    return f"{level.iterations} at {level.resolution}{own}{carried}"


def _preset(name: str) -> None:
    from regframe.catalog import INTERPOLATORS, METRICS, OPTIMIZERS, TRANSFORMS
    from regframe.cli.tables import table
    from regframe.preset import load, origin

    preset = load(name)
    place = name if name.endswith(".toml") else origin(name)
    typer.echo(f"{typer.style(preset.name, bold=True)} (preset, from {place}, seed {preset.seed})\n")
    typer.echo(inspect.cleandoc(preset.about or "No description.") + "\n")
    parts = [
        (
            f"stage {number + 1}",
            TRANSFORMS.name_of(stage.transform),
            METRICS.name_of(stage.metric),
            INTERPOLATORS.name_of(stage.interpolator),
            OPTIMIZERS.name_of(stage.optimizer),
            ", ".join(map(_level, stage.levels)),
        )
        for number, stage in enumerate(preset.stages)
    ]
    table(("stage", "transform", "metric", "interpolator", "optimizer", "iterations by level"), parts)
    typer.echo(f"\nEvery value: regframe preset show {name}")
    typer.echo(f"Use it:      regframe register FIXED MOVING --preset {name} --out FOLDER")


def _type(field: dict[str, Any]) -> str:
    if "enum" in field or "const" in field:
        return " | ".join(map(toml, field.get("enum", [field.get("const")])))
    if "anyOf" in field:
        return " or ".join(dict.fromkeys(_type(one) for one in field["anyOf"]))
    if field.get("type") == "array":
        return f"list of {_type((field.get('prefixItems') or [field.get('items', {})])[0])}"
    kind = str(field.get("type", "table"))
    return {"null": "none", "string": "text", "object": "table"}.get(kind, kind)


def _range(field: dict[str, Any]) -> str:
    parts = [field, *field.get("anyOf", [])]
    limits = [words.format(toml(part[key])) for part in parts for key, words in LIMITS.items() if key in part]
    return " and ".join(dict.fromkeys(limits))
