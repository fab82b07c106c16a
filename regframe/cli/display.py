"""Progress on the screen, as an observer of a run."""

import sys
from time import perf_counter
from types import TracebackType
from typing import TYPE_CHECKING, Literal, Self

import typer

if TYPE_CHECKING:
    from rich.console import Group
    from rich.live import Live

    from regframe.engine.base import Progress
    from regframe.preset import Preset

REFRESHES_A_SECOND = 12
BAR = 24

Manner = Literal["live", "plain", "none"]


def manner(quiet: bool) -> Manner:
    """How progress is shown: live on a terminal, a line a level in a pipe, not at all when quiet."""
    if quiet:
        return "none"
    return "live" if sys.stderr.isatty() else "plain"


class Display:
    """Shows a run while it goes; everything goes to the error stream, so that results can be piped.

    Use it as a context around the run and as one of its observers.

    Parameters
    ----------
    preset : Preset
        Tells how many stages and levels there are.
    manner : str
        See `manner`.
    """

    def __init__(self, preset: "Preset", manner: Manner) -> None:
        self._preset = preset
        self._manner = manner
        self._last: Progress | None = None
        self._ends: dict[int, float] = {}
        self._level_began = 0.0
        self._due = 0.0
        self._live: Live | None = None

    def __enter__(self) -> Self:
        if self._manner == "live":
            from rich.console import Console
            from rich.live import Live

            self._live = Live(
                "preparing ...", console=Console(stderr=True), auto_refresh=False, transient=True
            )
            self._live.start(refresh=True)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self._finish_level()
        if self._live is not None:
            self._live.stop()

    def __call__(self, progress: "Progress") -> None:
        """Take one iteration; draws at most twelve times a second."""
        last = self._last
        if last is not None and (last.stage, last.level) != (progress.stage, progress.level):
            self._finish_level()
        self._last = progress
        self._ends[progress.candidate] = progress.value
        now = perf_counter()
        if self._live is not None and now >= self._due:
            self._due = now + 1 / REFRESHES_A_SECOND
            self._live.update(self._picture(progress), refresh=True)

    def note(self, text: str) -> None:
        """Say on a terminal what is done after the last iteration."""
        if self._live is not None:
            self._live.update(text, refresh=True)

    def _finish_level(self) -> None:
        last = self._last
        if last is None or self._manner == "none":
            return
        seconds = last.seconds - self._level_began
        self._level_began = last.seconds
        line = f"{self._place(last)}: {self._outcome(last)}, {seconds:.2f} s"
        self._ends = {}
        if self._live is not None:
            self._live.console.print(line, highlight=False, soft_wrap=True)
        else:
            typer.echo(line, err=True)

    def _outcome(self, last: "Progress") -> str:
        """What the level's iterations came to; of a search's places, the values they reached."""
        if len(self._ends) > 1:
            best, worst = min(self._ends.values()), max(self._ends.values())
            return f"{len(self._ends)} places of the search, values {best:.4g} to {worst:.4g}"
        count = last.iteration + 1
        return f"{count} iteration{'' if count == 1 else 's'}, value {last.value:.6g}, step {last.size:.3g}"

    def _place(self, at: "Progress") -> str:
        stages = self._preset.stages
        levels = stages[at.stage].levels
        level = levels[at.level]
        words = f"level {at.level + 1}/{len(levels)} ({level.resolution})"
        return words if len(stages) == 1 else f"stage {at.stage + 1}/{len(stages)}, {words}"

    def _picture(self, at: "Progress") -> "Group":
        from rich.console import Group
        from rich.progress_bar import ProgressBar
        from rich.table import Table

        row = Table.grid(padding=(0, 2))
        row.add_row(
            self._place(at),
            ProgressBar(total=at.iterations, completed=at.iteration + 1, width=BAR),
            f"{at.iteration + 1}/{at.iterations}",
            f"[bold]value {at.value:.6g}[/bold]",
            f"step {at.size:.3g}",
            f"[dim]{at.seconds:.1f} s[/dim]",
        )
        return Group(row)
