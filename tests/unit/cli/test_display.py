import io
from types import SimpleNamespace

import pytest

from regframe.cli import display as module
from regframe.cli.display import Display, manner
from regframe.engine.base import Progress
from regframe.preset import load

PRESET = load("paper-similarity-pyramid")


def step(level, iteration, seconds=0.0):
    return Progress(0, level, iteration, 300, -0.5, None, 2.0, seconds, iteration + 2)


def test_pipes_get_a_line_a_level(capsys):
    with Display(PRESET, "plain") as display:
        for level in (0, 1):
            for i in range(3):
                display(step(level, i, level + 0.1 * i))

    lines = capsys.readouterr().err.splitlines()
    assert lines == [
        "level 1/3 (shrink 4): 3 iterations, value -0.5, step 2, 0.20 s",
        "level 2/3 (shrink 2): 3 iterations, value -0.5, step 2, 1.00 s",
    ]


def test_quiet_says_nothing(capsys):
    with Display(PRESET, "none") as display:
        display(step(0, 0))

    said = capsys.readouterr()
    assert (said.out, said.err) == ("", "")


def test_stages_are_named_where_there_are_several(capsys):
    twice = load(PRESET, {"stages.1": {**PRESET.stages[0].model_dump(mode="json"), "start": "previous"}})

    with Display(twice, "plain") as display:
        display(step(0, 0))

    assert capsys.readouterr().err.startswith("stage 1/2, level 1/3")


def test_a_failed_run_claims_no_finished_level(capsys):
    with pytest.raises(ValueError, match="lost"), Display(PRESET, "plain") as display:  # noqa: PT012
        display(step(0, 0))
        message = "lost"
        raise ValueError(message)

    assert capsys.readouterr().err == ""


def terminal(monkeypatch):
    """A terminal that remembers, and a clock that stands still.

    No fixture, because pytest puts its own error stream in place after fixtures have run.
    """
    screen = io.StringIO()
    screen.isatty = lambda: True
    clock = SimpleNamespace(now=100.0)
    monkeypatch.setattr(module.sys, "stderr", screen)
    monkeypatch.setattr(module, "perf_counter", lambda: clock.now)
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setenv("COLUMNS", "120")
    return screen, clock


def test_terminals_are_drawn_live(monkeypatch):
    terminal(monkeypatch)

    assert manner(quiet=False) == "live"
    assert manner(quiet=True) == "none"


def test_the_live_line_shows_level_iteration_value_and_step(monkeypatch):
    screen, _ = terminal(monkeypatch)

    with Display(PRESET, "live") as display:
        display(step(1, 41, 0.5))

    for words in ("level 2/3", "42/300", "-0.5", "step 2", "0.5 s"):
        assert words in screen.getvalue()


def test_drawing_is_limited_to_twelve_times_a_second(monkeypatch):
    screen, clock = terminal(monkeypatch)

    with Display(PRESET, "live") as display:
        for i in range(300):
            clock.now += 0.001
            display(step(0, i))

    drawn = screen.getvalue().count("/300")
    # Four in 0.3 s, and what rich draws again when it prints above the line and stops.
    assert 4 <= drawn <= 6


def test_finished_levels_stay_on_the_screen(monkeypatch):
    screen, _ = terminal(monkeypatch)

    with Display(PRESET, "live") as display:
        display(step(0, 0))
        display(step(1, 0))

    assert "level 1/3 (shrink 4): 1 iteration," in screen.getvalue()
