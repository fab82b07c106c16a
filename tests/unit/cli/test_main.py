import subprocess
import sys

import pytest

from regframe import __version__
from regframe.cli import listing
from regframe.errors import NoOverlapError, PresetError

HEAVY = ("pydantic", "numpy", "numba", "SimpleITK", "matplotlib", "scipy")


def test_help_imports_nothing_heavy():
    script = (
        "import sys; from regframe.cli.main import run; code = run(['--help']); "
        f"sys.exit(code or ' '.join(name for name in {HEAVY} if name in sys.modules) or 0)"
    )

    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)

    assert (done.returncode, done.stderr) == (0, "")
    assert "register" in done.stdout


def test_the_module_is_the_command():
    done = subprocess.run(
        [sys.executable, "-m", "regframe", "--version"], capture_output=True, text=True, check=False
    )

    assert (done.returncode, done.stdout) == (0, f"regframe {__version__}\n")


@pytest.mark.parametrize("arguments", [(), ("--help",), ("-h",), ("register", "--help"), ("preset", "-h")])
def test_help_is_no_error(arguments, regframe):
    outcome = regframe(*arguments)

    assert outcome.code == 0
    assert "Usage" in outcome.out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("registr",), "Did you mean 'register'"),
        (("register",), "FIXED"),
        (("register", "a.png", "b.png", "--presett", "x"), "--preset"),
        (("register", "a.png", "b.png", "--seed", "one"), "integer"),
        (("register", "a.png", "b.png", "--threads", "0"), "--threads"),
        (("apply", "a.tfm", "b.png"), "--like"),
        (("preset",), "Missing command"),
        (("preset", "shwo"), "Did you mean 'show'"),
    ],
)
def test_wrong_usage_is_one_line_with_a_hint(arguments, said, regframe):
    outcome = regframe(*arguments)

    assert outcome.code == 2
    assert outcome.out == ""
    assert said in outcome.err
    assert outcome.err.startswith("regframe: ")
    assert outcome.err.count("\n") == 1
    assert "--help'" in outcome.err


def raising(error):
    def rows(_):
        raise error

    return rows


@pytest.mark.parametrize(
    ("error", "code"),
    [(NoOverlapError("nothing meets"), 1), (PresetError("a fault"), 2), (KeyboardInterrupt(), 130)],
)
def test_the_exit_code_tells_what_happened(error, code, regframe, monkeypatch):
    monkeypatch.setattr(listing, "rows", raising(error))

    outcome = regframe("list", "metrics")

    assert outcome.code == code
    assert outcome.err.startswith("regframe: ")
    assert outcome.err.count("\n") == 1


def test_a_single_fault_joins_its_title(regframe, monkeypatch):
    monkeypatch.setattr(listing, "rows", raising(PresetError("preset 'x':\nseed: must be at least 0.")))

    assert regframe("list", "metrics").err == "regframe: preset 'x': seed: must be at least 0.\n"


def test_several_faults_stand_one_a_line(regframe, monkeypatch):
    monkeypatch.setattr(listing, "rows", raising(PresetError("preset 'x':\na: one.\nb: two.")))

    assert regframe("list", "metrics").err == "regframe: preset 'x':\n  a: one.\n  b: two.\n"


def test_debugging_shows_the_whole_error(regframe, monkeypatch):
    monkeypatch.setattr(listing, "rows", raising(PresetError("a fault")))
    monkeypatch.setenv("REGFRAME_DEBUG", "1")

    with pytest.raises(PresetError):
        regframe("list", "metrics")


def test_faults_of_ours_are_not_hidden(regframe, monkeypatch):
    monkeypatch.setattr(listing, "rows", raising(ZeroDivisionError()))

    with pytest.raises(ZeroDivisionError):
        regframe("list", "metrics")


def test_a_reader_who_leaves_is_no_error():
    script = "import sys; from regframe.cli.main import run; sys.exit(run(['list']))"
    with subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        process.stdout.close()
        error = process.stderr.read()
        process.wait()

    assert (process.returncode, error) == (0, "")
