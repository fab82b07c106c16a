import os

import pytest

from regframe.io.muted import muted


def test_collects_both_streams(capfd):
    with muted() as said:
        os.write(1, b"out\n")
        os.write(2, b"error\n")

    assert said == ["out", "error"]
    assert capfd.readouterr() == ("", "")


def test_restores_both_streams_after_an_error(capfd):
    def fail():
        with muted():
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    os.write(1, b"out")
    os.write(2, b"error")

    assert capfd.readouterr() == ("out", "error")


def test_keeps_what_python_had_not_printed_yet(capfd):
    print("before", end="")  # noqa: T201 -- buffered text is what this is about
    with muted() as said:
        os.write(1, b"inside")

    assert said == ["inside"]
    assert capfd.readouterr().out == "before"


def test_works_without_python_streams(monkeypatch):
    monkeypatch.setattr("sys.stdout", None)
    monkeypatch.setattr("sys.stderr", None)

    with muted() as said:
        os.write(2, b"error")

    assert said == ["error"]
