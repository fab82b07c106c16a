"""``regframe check``: every claim that a component must hold, tried one by one."""

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from regframe.cli import plugin_files
from regframe.cli.plugin_files import Plugins

if TYPE_CHECKING:
    from regframe.component import Component
    from regframe.registry import AnyRegistry
    from regframe.testing.checks import Verdict
    from regframe.testing.cost import Cost

Kind = Annotated[
    str, typer.Argument(metavar="KIND", help="metric, transform, interpolator, optimizer or filter.")
]
Name = Annotated[str, typer.Argument(metavar="NAME", help="A component's name; see regframe list.")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="OPTION=VALUE", help="Check it with an option, e.g. bins=32."),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print the verdicts as JSON, and nothing else.")]

FAILS = 1
COLOURS = {"holds": typer.colors.GREEN, "fails": typer.colors.RED, "does not apply": None}
WIDTH = 16
"""Columns of the outcome, in front of the claim."""


def check(
    kind: Kind, name: Name, settings: Settings = None, plugin: Plugins = None, as_json: AsJson = False
) -> None:
    """Run the conformance suite on a component and tell a verdict a claim; exit with 1 if one fails."""
    from regframe.catalog import of_kind
    from regframe.preset import setting
    from regframe.testing.checks import verify

    plugin_files.use(plugin)
    registry = of_kind(kind)
    component = registry.build({"type": name, **dict(map(setting, settings or []))})
    verdicts = verify(component)
    price = _cost(component)
    (_print_json if as_json else _print)(registry, component, verdicts, price)
    if not all(verdict.passed for verdict in verdicts):
        raise typer.Exit(FAILS)


def _cost(component: "Component") -> "Cost | None":
    from regframe.metrics.base import Metric
    from regframe.testing.cost import cost

    return cost(component) if isinstance(component, Metric) else None


def _print(
    registry: "AnyRegistry", component: "Component", verdicts: Sequence["Verdict"], price: "Cost | None"
) -> None:
    name = registry.name_of(component)
    typer.echo(f"{typer.style(name, bold=True)} ({registry.kind}, from {registry.origin(name)})\n")
    for verdict in verdicts:
        outcome = verdict.outcome.upper() if not verdict.passed else verdict.outcome
        typer.echo(typer.style(f"{outcome:{WIDTH}}", fg=COLOURS[verdict.outcome]) + verdict.name)
        if verdict.message:
            typer.echo(f"{'':{WIDTH}}  {verdict.message}")
    counts = Counter(verdict.outcome for verdict in verdicts)
    typer.echo(
        f"\n{counts['holds']} claims hold, {counts['fails']} fail, {counts['does not apply']} do not apply."
    )
    if price is not None:
        typer.echo(f"Cost: {price.nanoseconds:.1f} ns a sample, {price.ratio:.1f} times mean-squares.")


def _print_json(
    registry: "AnyRegistry", component: "Component", verdicts: Sequence["Verdict"], price: "Cost | None"
) -> None:
    import json
    from dataclasses import asdict

    record = {
        "kind": registry.kind,
        "component": registry.dump(component),
        "origin": registry.origin(registry.name_of(component)),
        "passed": all(verdict.passed for verdict in verdicts),
        "verdicts": [asdict(verdict) for verdict in verdicts],
        "cost": None if price is None else asdict(price),
    }
    typer.echo(json.dumps(record, indent=2))
