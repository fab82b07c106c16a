"""The command line: commands put together, errors told in one line.

Only typer is imported here and at the top of the command modules, so that ``regframe --help`` is quick;
each command imports what it needs when it runs.
"""

import os
import sys
from collections.abc import Sequence
from typing import Annotated

import typer

from regframe import __version__
from regframe.cli import (
    apply,
    check,
    crosscheck,
    demo,
    doctor,
    explain,
    listing,
    new,
    preset,
    register,
    warmup,
)
from regframe.errors import NoOverlapError, RegframeError

DONE, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130

# Typer passes on click's UsageError, or its own copy in later versions, but exports only this child of it.
UsageError: type[Exception] = typer.BadParameter.__bases__[0]

app = typer.Typer(
    name="regframe",
    help="Align two images of one scene: visual and thermal frames, medical slices and volumes.",
    epilog="Begin with: regframe demo",
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.command("register")(register.register)
app.command("apply")(apply.apply)
app.command("crosscheck")(crosscheck.crosscheck)
app.command("list")(listing.show)
app.command("explain")(explain.explain)
app.add_typer(preset.app, name="preset")
app.command("check")(check.check)
app.command("new")(new.new)
app.command("demo")(demo.demo)
app.command("doctor")(doctor.doctor)
app.command("warmup")(warmup.warmup)


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"regframe {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Align two images of one scene: visual and thermal frames, medical slices and volumes."""


def run(arguments: Sequence[str]) -> int:
    """Run one command line and tell its exit code.

    Returns
    -------
    int
        0 done; 1 the registration failed, with a reason; 2 bad input; 130 interrupted.
    """
    try:
        code = app(list(arguments) or ["--help"], prog_name="regframe", standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        code = INTERRUPTED
    except SystemExit as left:
        # The reader of a pipe has seen enough: typer leaves with 1, but nothing has failed.
        return DONE if isinstance(left.__context__, BrokenPipeError) else BAD_INPUT
    except RegframeError as error:
        if os.environ.get("REGFRAME_DEBUG"):
            raise
        _tell(str(error))
        return FAILED if isinstance(error, NoOverlapError) else BAD_INPUT
    except UsageError as error:
        _tell(_usage(error))
        return BAD_INPUT
    if code == INTERRUPTED:
        # Typer's versions differ in whether they pass on the interruption or return its code.
        _tell("interrupted; no file is left half-written.")
    return code if isinstance(code, int) else DONE


def main() -> None:
    """Run the command line of this process."""
    sys.exit(run(sys.argv[1:]))


def _usage(error: Exception) -> str:
    text = str(getattr(error, "format_message", error.__str__)())
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "regframe"
    closed = text.rstrip(".")
    return f"{closed}{'' if closed.endswith('?') else '.'} Try '{command} --help'."


def _tell(message: str) -> None:
    """One line on the error stream; several faults are joined under their title."""
    title, _, faults = message.partition("\n")
    lines = faults.splitlines()
    if len(lines) == 1:
        title, lines = f"{title} {lines[0]}", []
    for line in (f"regframe: {title}", *(f"  {line}" for line in lines)):
        typer.secho(line, err=True, fg=typer.colors.RED)
