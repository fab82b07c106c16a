"""``--plugin`` and the configuration on the command line."""

import pytest

from regframe import plugins
from regframe.catalog import METRICS
from support.plugin_files import GOOD, HALFWAY, TAKEN

pytestmark = pytest.mark.usefixtures("forgotten")


@pytest.fixture
def mine(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(GOOD)
    return path


def test_a_preset_uses_a_named_file(mine, pair, tmp_path, regframe):
    lines = ['extends = "paper-similarity"', '"stages.0.metric" = "least-distance"']
    (tmp_path / "own.toml").write_text("\n".join([*lines, '"stages.0.levels.0.iterations" = 3']))

    without = regframe("register", *pair, "--preset", tmp_path / "own.toml")
    outcome = regframe("register", *pair, "--preset", tmp_path / "own.toml", "--plugin", mine)

    assert without.code == 2
    assert "no metric is called 'least-distance'" in without.err
    assert outcome.code == 0


@pytest.mark.parametrize(
    "words",
    [
        ("list", "metrics"),
        ("explain", "least-distance"),
        ("check", "metric", "least-distance"),
        ("preset", "show", "paper-similarity", "--set", "stages.0.metric=least-distance"),
        ("preset", "schema"),
        ("doctor",),
    ],
)
def test_a_command_knows_a_named_file(words, mine, regframe):
    outcome = regframe(*words, "--plugin", mine)

    assert outcome.code == 0
    assert outcome.err == ""
    assert "least-distance" in outcome.out


def test_the_configuration_is_read_by_every_command(mine, tmp_path, regframe, monkeypatch):
    (tmp_path / "config.toml").write_text('[plugins]\nfiles = ["mine.py"]\n')
    monkeypatch.setenv(plugins.CONFIG, str(tmp_path / "config.toml"))

    outcome = regframe("list", "metrics")

    assert "least-distance" in outcome.out
    assert str(mine) in outcome.out


def test_faults_are_told_and_the_rest_works(mine, tmp_path, regframe):
    (tmp_path / "broken.py").write_text(HALFWAY)
    (tmp_path / "taken.py").write_text(TAKEN.replace("LeastDistance", "FarDistance"))

    outcome = regframe(
        "list",
        "metrics",
        "--plugin",
        tmp_path / "broken.py",
        "--plugin",
        tmp_path / "taken.py",
        "--plugin",
        mine,
    )

    assert outcome.code == 0
    assert "least-distance" in outcome.out
    assert "far-distance" in outcome.out
    assert "broken.py' cannot be imported: RuntimeError: no gpu" in outcome.err
    assert "'mattes' is already the name of a metric (regframe)" in outcome.err


def test_doctor_lists_files_and_their_faults(mine, tmp_path, regframe, monkeypatch):
    (tmp_path / "broken.py").write_text(HALFWAY)
    (tmp_path / "config.toml").write_text('[plugins]\nfiles = ["broken.py", "mine.py", "gone.py"]\n')
    monkeypatch.setenv(plugins.CONFIG, str(tmp_path / "config.toml"))

    outcome = regframe("doctor")

    assert outcome.code == 0
    assert f"{tmp_path / 'config.toml'}: 3 plugin files" in outcome.out
    assert "cannot be imported: RuntimeError: no gpu" in outcome.out
    assert "gone.py' does not exist" in outcome.out
    assert f"metric of {mine}" in outcome.out


def test_a_file_that_is_not_there_stops_the_command(tmp_path, regframe):
    outcome = regframe("list", "--plugin", tmp_path / "none.py")

    assert outcome.code == 2
    assert "none.py' does not exist" in outcome.err


def test_a_name_of_the_configuration_counts_as_taken(mine, tmp_path, regframe, monkeypatch):
    (tmp_path / "config.toml").write_text('[plugins]\nfiles = ["mine.py"]\n')
    monkeypatch.setenv(plugins.CONFIG, str(tmp_path / "config.toml"))

    assert (
        f"'least-distance' is already the name of a metric ({mine})"
        in regframe("new", "metric", "least-distance").err
    )
    assert "least-distance" in METRICS.names()
