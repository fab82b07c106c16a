"""A small pair of files, and the command line as a function."""

from dataclasses import dataclass

import pytest

from regframe.cli.main import run
from regframe.io import write
from regframe.testing.phantoms import visual_thermal

QUICK = ("--set", "stages.0.levels.0.iterations=4")


@dataclass(frozen=True)
class Outcome:
    """What a command left: its exit code and what it said where."""

    code: int
    out: str
    err: str


@pytest.fixture(scope="session")
def phantom():
    return visual_thermal(1, (60, 80))


@pytest.fixture
def pair(phantom, tmp_path):
    """Paths of a visual and a thermal frame."""
    paths = tmp_path / "visual.png", tmp_path / "thermal.png"
    for image, path in zip((phantom.fixed, phantom.moving), paths, strict=True):
        write(image.raw, image.grid, path)
    return paths


@pytest.fixture
def regframe(capsys, monkeypatch):
    """Runs a command line; every argument becomes text."""
    monkeypatch.delenv("REGFRAME_DEBUG", raising=False)
    monkeypatch.setenv("REGFRAME_THREADS", "1")
    monkeypatch.setenv("COLUMNS", "160")

    def command(*arguments):
        capsys.readouterr()
        code = run([str(argument) for argument in arguments])
        said = capsys.readouterr()
        return Outcome(code, said.out, said.err)

    return command
