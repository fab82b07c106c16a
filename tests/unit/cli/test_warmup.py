from regframe.preset import names


def test_every_preset_is_run_and_timed(regframe):
    outcome = regframe("warmup")

    assert outcome.code == 0
    assert outcome.err == ""
    for name in names():
        assert f"{name} 2-D: " in outcome.out
    assert "3-D" in outcome.out
