import pytest

from regframe.preset import names
from support.plugin_files import GOOD

pytestmark = pytest.mark.usefixtures("forgotten")


@pytest.mark.slow
def test_every_preset_is_run_and_timed(regframe):
    outcome = regframe("warmup")

    assert outcome.code == 0
    assert outcome.err == ""
    for name in names():
        assert f"{name} 2-D: " in outcome.out or f"{name} 3-D: " in outcome.out
    assert "paper-affine 3-D: " in outcome.out
    assert "sitk-weights 2-D: " not in outcome.out


def test_a_preset_with_a_file_of_ones_own_is_run_alone(regframe, tmp_path):
    (tmp_path / "mine.py").write_text(GOOD)
    lines = ['extends = "paper-similarity"', '"stages.0.metric" = "least-distance"']
    (tmp_path / "own.toml").write_text("\n".join(lines))

    outcome = regframe("warmup", tmp_path / "own.toml", "--plugin", tmp_path / "mine.py")

    assert outcome.code == 0
    flat, deep, last = outcome.out.splitlines()
    assert flat.startswith(f"{tmp_path / 'own.toml'} 2-D: ")
    assert deep.startswith(f"{tmp_path / 'own.toml'} 3-D: ")
    assert last.startswith("Their kernels are compiled")


@pytest.mark.parametrize("wrong", ["paper-similarly", "not-there.toml"])
def test_an_unknown_preset_is_told_before_anything_runs(wrong, regframe):
    outcome = regframe("warmup", "paper-similarity", wrong)

    assert outcome.code == 2
    assert wrong in outcome.err
    assert outcome.out == ""
