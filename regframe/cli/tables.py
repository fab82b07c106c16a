"""Tables of text: ruled on a terminal, plain columns in a pipe."""

import sys
from collections.abc import Sequence

import typer


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print rows under a head; in a pipe one line a row, so that they can be searched and cut."""
    if sys.stdout.isatty():
        _ruled(head, rows)
        return
    widths = [max(len(row[i]) for row in (head, *rows)) for i in range(len(head))]
    for row in (head, *rows):
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        typer.echo("  ".join(cells).rstrip())


def _ruled(head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    ruled = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for place, title in enumerate(head):
        ruled.add_column(title, style="bold" if place == 0 else "", overflow="fold", no_wrap=place == 0)
    for row in rows:
        ruled.add_row(*map(Text, row))
    Console().print(ruled)
