import pytest

from regframe.cli import demo as command
from regframe.report import files
from regframe.testing.phantoms import visual_thermal


@pytest.fixture(autouse=True)
def small(monkeypatch, tmp_path):
    """The same scene in few pixels, in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        "regframe.testing.phantoms.visual_thermal", lambda seed: visual_thermal(seed, (60, 80))
    )


def test_prints_the_error_and_writes_the_pictures(tmp_path, regframe):
    outcome = regframe("demo")

    folder = tmp_path / command.FOLDER
    assert outcome.code == 0
    assert "corner error before" in outcome.out
    assert "corner error after" in outcome.out
    assert {*command.PAIR, "aligned.png", *files.OVERLAYS, *files.PLOTS} <= {
        path.name for path in folder.iterdir()
    }


def test_what_it_proposes_next_works(regframe):
    proposed = [
        line.split()[1:] for line in regframe("demo").out.splitlines() if line.startswith("  regframe ")
    ]

    assert len(proposed) == 3
    assert [regframe(*line).code for line in proposed] == [0, 0, 0]


@pytest.mark.slow
def test_a_second_demo_takes_a_folder_of_its_own(tmp_path, regframe):
    regframe("demo")

    regframe("demo")

    assert (tmp_path / f"{command.FOLDER}-2" / "aligned.png").is_file()


@pytest.mark.slow
def test_a_named_folder_with_a_result_is_refused(regframe):
    regframe("demo", "--out", "mine")

    outcome = regframe("demo", "--out", "mine")

    assert outcome.code == 2
    assert "--force" in outcome.err
    assert regframe("demo", "--out", "mine", "--force").code == 0
