"""A new plugin works as it is made; wrong wishes are refused before anything is written."""

import os
import subprocess
import sys
import tomllib

import pytest

from regframe.catalog import KINDS
from regframe.preset import load
from regframe.testing import verify

SINGULAR = [registry.kind for registry in KINDS.values()]


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """An empty working folder; what is imported from it is forgotten afterwards."""
    monkeypatch.chdir(tmp_path)
    known = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - known:
        if name.startswith("regframe_"):
            del sys.modules[name]


def as_installed(folder, monkeypatch):
    """Put a plugin's folder on the import path with the entry points that its pyproject.toml names."""
    project = tomllib.loads((folder / "pyproject.toml").read_text())["project"]
    info = folder / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: 0.1.0\n")
    lines = [
        line
        for group, points in project["entry-points"].items()
        for line in (f"[{group}]", *(f"{name} = {target}" for name, target in points.items()))
    ]
    (info / "entry_points.txt").write_text("\n".join(lines))
    monkeypatch.syspath_prepend(folder)


@pytest.mark.parametrize("kind", SINGULAR)
def test_a_new_plugin_passes_every_check_and_is_listed(kind, place, regframe, monkeypatch):
    made = regframe("new", kind, f"my-own-{kind}")
    as_installed(place / f"my-own-{kind}", monkeypatch)

    listed = regframe("list", f"{kind}s")
    registry = KINDS[f"{kind}s"]
    verdicts = verify(registry.build(f"my-own-{kind}"))

    assert made.code == 0
    assert f"my-own-{kind} " in listed.out
    assert f"regframe-my-own-{kind}" in listed.out
    assert [verdict for verdict in verdicts if not verdict.passed] == []
    assert registry.faults() == {}


@pytest.mark.parametrize("kind", SINGULAR)
def test_the_preset_of_a_new_plugin_uses_it(kind, place, regframe, monkeypatch):
    regframe("new", kind, "my-own")
    as_installed(place / "my-own", monkeypatch)

    preset = load(place / "my-own" / "regframe_my_own" / "my-own-example.toml")

    used = preset.filters.moving[0] if kind == "filter" else getattr(preset.stages[0], kind)
    assert KINDS[f"{kind}s"].name_of(used) == "my-own"


@pytest.mark.parametrize("kind", SINGULAR)
def test_a_new_plugin_is_formatted_as_it_should_be(kind, regframe):
    regframe("new", kind, "my-own")

    ruff = [sys.executable, "-m", "ruff"]
    if subprocess.run([*ruff, "--version"], capture_output=True, check=False).returncode:
        pytest.skip("ruff is not installed here")
    # The widths and orders that ruff has by itself, as most readers do.
    for command in (["format", "--check"], ["check", "--select", "E,F,I,B,UP"]):
        said = subprocess.run(
            [*ruff, *command, "--isolated", "--no-cache", "."], capture_output=True, text=True, check=False
        )
        assert said.returncode == 0, said.stdout


def test_its_test_file_is_two_lines_of_code(place, regframe):
    regframe("new", "metric", "my-own")

    code = [line for line in (place / "my-own" / "tests" / "test_my_own.py").read_text().splitlines() if line]
    assert code == [
        "from regframe.testing import conformance",
        'test_conformance = conformance("metric", "my-own")',
    ]


def test_the_next_steps_are_told(regframe):
    told = regframe("new", "metric", "my-own").out

    assert "pip install -e my-own" in told
    assert "regframe check metric my-own" in told


def test_out_names_the_folder(place, regframe):
    regframe("new", "filter", "my-own", "--out", "deep/inside")

    assert (place / "deep" / "inside" / "pyproject.toml").is_file()


def test_a_class_does_not_hide_what_it_imports(place, regframe):
    regframe("new", "metric", "pairs")

    assert "class PairsMetric(Metric)" in (place / "pairs" / "regframe_pairs" / "__init__.py").read_text()


@pytest.mark.parametrize(
    ("name", "better"),
    [
        ("MyMetric", "my-metric"),
        ("my_metric", "my-metric"),
        ("my metric", "my-metric"),
        ("3d", "my-metric"),
        ("../up", "up"),
        ("", "my-metric"),
    ],
)
def test_a_bad_name_is_answered_with_a_good_one(name, better, place, regframe):
    outcome = regframe("new", "metric", name)

    assert outcome.code == 2
    assert f"Got {name!r}. Write {better!r}." in outcome.err
    assert list(place.iterdir()) == []


def test_a_taken_name_is_refused(regframe):
    outcome = regframe("new", "metric", "mattes")

    assert outcome.code == 2
    assert "'mattes' is already the name of a metric (regframe). Choose another." in outcome.err


def test_an_installed_distribution_of_that_name_is_told(place, regframe, monkeypatch):
    regframe("new", "metric", "my-own")
    as_installed(place / "my-own", monkeypatch)

    outcome = regframe("new", "filter", "my-own", "--out", "other")

    assert "a distribution 'regframe-my-own' is installed" in outcome.err


def test_an_unknown_kind_is_answered_with_the_nearest(regframe):
    assert "there is no kind 'metrik'. Did you mean 'metric'?" in regframe("new", "metrik", "mine").err


def test_an_existing_folder_is_left_alone(place, regframe):
    (place / "my-own").mkdir()

    outcome = regframe("new", "metric", "my-own")

    assert outcome.code == 2
    assert "'my-own' exists already. Name another with --out, or add --force" in outcome.err
    assert list((place / "my-own").iterdir()) == []


def test_force_replaces_its_own_files_and_no_others(place, regframe):
    regframe("new", "metric", "my-own")
    source = place / "my-own" / "regframe_my_own" / "__init__.py"
    fresh = source.read_text()
    source.write_text("changed")
    (place / "my-own" / "notes.txt").write_text("mine")

    outcome = regframe("new", "metric", "my-own", "--force")

    assert outcome.code == 0
    assert source.read_text() == fresh
    assert (place / "my-own" / "notes.txt").read_text() == "mine"


def test_a_file_is_never_replaced_by_a_folder(place, regframe):
    (place / "my-own").write_text("a file")

    assert (
        "'my-own' exists already. Name another with --out." in regframe("new", "metric", "my-own", "-f").err
    )


@pytest.mark.slow
def test_new_plugins_install_and_pass_their_own_tests(place, regframe):
    folders = [f"my-own-{kind}" for kind in SINGULAR]
    for kind, folder in zip(SINGULAR, folders, strict=True):
        regframe("new", kind, folder)
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", "site"]
    subprocess.run([*pip, *(f"./{folder}" for folder in folders)], check=True)

    def said(*words):
        run = [sys.executable, "-m", *words]
        environment = {**os.environ, "PYTHONPATH": str(place / "site")}
        return subprocess.run(run, env=environment, capture_output=True, text=True, check=False)

    listed = said("regframe", "list")
    shown = said("regframe", "preset", "show", "my-own-metric-example")
    tested = said("pytest", "-q", "-p", "no:cacheprovider", *(f"{folder}/tests" for folder in folders))
    checked = said("regframe", "check", "metric", "my-own-metric")
    assert [folder for folder in folders if f"regframe-{folder}" not in listed.stdout] == []
    assert 'type = "my-own-metric"' in shown.stdout
    assert tested.returncode == 0, tested.stdout
    assert checked.returncode == 0, checked.stdout
