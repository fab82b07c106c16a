"""What is said at the end of a registration: in full, in a line, or as JSON."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import typer

if TYPE_CHECKING:
    from regframe.engine.base import Result

COLOURS = {"good": typer.colors.GREEN, "doubtful": typer.colors.YELLOW, "failed": typer.colors.RED}


@dataclass(frozen=True)
class Outcome:
    """A result and what became of it.

    Parameters
    ----------
    result : Result
    out : Path or None
        The folder it was written into.
    verdict : bool
        Whether it was judged.
    withheld : bool
        Whether aligned image and transform were kept back.
    """

    result: "Result"
    out: Path | None
    verdict: bool
    withheld: bool

    @classmethod
    def of(cls, result: "Result", out: Path | None, *, verdict: bool, keep_failed: bool) -> "Outcome":
        """Judge a result, if it is to be judged."""
        return cls(result, out, verdict, verdict and not keep_failed and result.verdict == "failed")

    def save(self, *, force: bool, figures: bool) -> None:
        """Write what may be written, if there is a folder."""
        from regframe.report import files

        if self.out is not None:
            files.save(
                self.result,
                self.out,
                force=force,
                figures=figures,
                verdict=self.verdict,
                keep_failed=not self.withheld,
            )

    def tell(self, manner: Literal["json", "line", "full"]) -> int:
        """Print it, and tell the exit code."""
        {"json": self._as_json, "line": self._in_a_line, "full": self._in_full}[manner]()
        return int(self.withheld)

    def _as_json(self) -> None:
        """Print the record, the transform in it unless it is withheld."""
        from regframe.report import records

        transform = None if self.withheld else records.transform_record(self.result)
        record = records.result_record(self.result, verdict=self.verdict)
        typer.echo(records.to_json({**record, "transform": transform}))

    def _in_a_line(self) -> None:
        """Print the verdict, the map, and where it was written."""
        from regframe.report import html

        facts = dict(html.facts(self.result))
        said = f"{self.result.verdict}; " if self.verdict else ""
        place = "" if self.out is None else f"; wrote {self.out}"
        typer.echo(f"{said}{facts['map']}; value {self.result.value:.6g}; {facts['effort']}{place}")

    def _in_full(self) -> None:
        """Print a table of facts, the verdict with its reasons, and what to look at."""
        from regframe.report import html

        for name, text in html.facts(self.result):
            _line(name, text)
        if self.verdict:
            self._judged()
        if self.out is None:
            typer.echo(
                "Nothing was written. Add --out FOLDER for the aligned image, the transform and pictures."
            )
        else:
            self._written(self.out)

    def _judged(self) -> None:
        verdict = self.result.verdict
        _line("verdict", typer.style(verdict.summary(), fg=COLOURS.get(verdict), bold=True))
        for reason in verdict.reasons[verdict.probability is None :]:
            _line("", reason)

    def _written(self, out: Path) -> None:
        from regframe.report.files import earlier

        names = earlier(out)
        _line("wrote", f"{len(names)} files in {out}")
        if self.withheld:
            typer.echo("The aligned image and the transform were withheld. Add --keep-failed to write them.")
        if "overlay-red-cyan.png" in names:
            typer.echo(f"Look at {out / 'overlay-red-cyan.png'} next to {out / 'overlay-before.png'}.")


def _line(name: str, text: str) -> None:
    typer.echo(typer.style(f"{name:11}", bold=True) + text)
