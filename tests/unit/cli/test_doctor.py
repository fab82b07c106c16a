from regframe.catalog import METRICS
from regframe.cli import doctor as command


def test_tells_versions_threads_and_cache(regframe):
    outcome = regframe("doctor")

    assert outcome.code == 0
    for word in ("python", "regframe", "numba", "SimpleITK", "threads", "kernel cache", "extras", "plugins"):
        assert word in outcome.out
    assert "1 (REGFRAME_THREADS=1)" in outcome.out


def test_a_missing_extra_names_its_install_line(regframe, monkeypatch):
    monkeypatch.setattr(command, "EXTRAS", (("nothing", "no_such_module", "features"),))

    assert 'pip install "regframe[features]"' in regframe("doctor").out


def test_a_broken_plugin_is_named(regframe, monkeypatch):
    monkeypatch.setattr(type(METRICS), "faults", lambda _: {"bad": "cannot be imported"})

    assert "FAULT: cannot be imported" in regframe("doctor").out
