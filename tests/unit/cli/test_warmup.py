from regframe.preset import names


def test_every_preset_is_run_and_timed(regframe):
    outcome = regframe("warmup")

    assert outcome.code == 0
    assert outcome.err == ""
    for name in names():
        assert f"{name} 2-D: " in outcome.out or f"{name} 3-D: " in outcome.out
    assert "paper-affine 3-D: " in outcome.out
    assert "sitk-weights 2-D: " not in outcome.out
