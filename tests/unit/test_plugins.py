"""A user's own files: named, loaded, and told apart when they are faulty."""

import pytest

from regframe import plugins
from regframe.catalog import FILTERS, METRICS
from regframe.errors import PresetError
from regframe.preset import load as load_preset
from regframe.preset import parse
from regframe.testing import verify
from support.plugin_files import GOOD, HALFWAY, REGISTERED, TAKEN

pytestmark = pytest.mark.usefixtures("forgotten")

ABSTRACT = '''
from regframe import Metric

class Half(Metric):
    """Says nothing."""
'''
NO_KIND = '''
from regframe.component import Component

class Thing(Component):
    """Of no kind."""
'''
WRONG_BASE = '''
from regframe import METRICS, Filter

@METRICS.register("odd")
class Odd(Filter):
    """A filter that is called a metric."""

    def __call__(self, image):
        return image
'''
STRANGER = """
class Mine:
    def value(self, pairs):
        return 0.0
"""


@pytest.fixture
def file(tmp_path):
    """Writes a plugin file."""

    def write(code, name="mine.py"):
        path = tmp_path / name
        path.write_text(code, encoding="utf-8")
        return path

    return write


@pytest.fixture
def config(tmp_path, monkeypatch):
    """Writes the configuration."""

    def write(text):
        path = tmp_path / "settings.toml"
        path.write_text(text, encoding="utf-8")
        monkeypatch.setenv(plugins.CONFIG, str(path))
        return path

    return write


def test_a_class_is_called_by_its_name_in_kebab_case(file):
    loaded = plugins.load(file(GOOD))

    assert loaded.found == (("metric", "least-distance"),)
    assert loaded.faults == ()
    assert METRICS.build("least-distance")


def test_a_name_that_the_file_gives_stays(file):
    loaded = plugins.load(file(REGISTERED))

    assert loaded.found == (("filter", "chosen"),)


def test_its_origin_is_the_file(file):
    path = file(GOOD)

    plugins.load(path)

    assert METRICS.origin("least-distance") == str(path)


def test_it_passes_the_conformance_suite_a_new_process_included(file):
    plugins.load(file(GOOD))

    verdicts = {verdict.name: verdict for verdict in verify(METRICS.build("least-distance"))}

    assert [verdict for verdict in verdicts.values() if not verdict.passed] == []
    assert verdicts["is the same in a new process"].outcome == "holds"


def test_loading_a_file_again_is_no_fault(file):
    path = file(GOOD)

    plugins.load(path)

    assert plugins.load(path).faults == ()
    assert plugins.files() == [path]


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (TAKEN, "class Mattes: 'mattes' is already the name of a metric (regframe). Choose another name."),
        (ABSTRACT, "class Half: it lacks value. Write what every metric must have."),
        (NO_KIND, "class Thing: it is of no kind. Derive it from one of Metric, Transform"),
        (WRONG_BASE, "cannot be imported: 'odd' cannot be a metric"),
        (STRANGER, "holds no component: a class that derives from Metric, Transform"),
        (HALFWAY, "cannot be imported: RuntimeError: no gpu"),
        (
            "import no_such_package",
            "cannot be imported: ModuleNotFoundError: No module named 'no_such_package'",
        ),
        ("def (", "cannot be imported: SyntaxError"),
        ("import sys; sys.exit(3)", "cannot be imported: SystemExit: 3"),
    ],
)
def test_a_fault_is_named_with_its_file(code, words, file):
    path = file(code)

    (fault,) = plugins.load(path).faults

    assert fault.startswith(f"the plugin {str(path)!r}")
    assert words in fault


def test_a_fault_takes_nothing_else_down(file):
    loaded = plugins.load(file(TAKEN))

    assert loaded.found == (("metric", "least-distance"),)
    assert METRICS.origin("mattes") == "regframe"


def test_a_file_that_breaks_halfway_leaves_nothing_behind(file):
    plugins.load(file(HALFWAY))

    assert "chosen" not in FILTERS.names()
    assert plugins.files() == []


def test_a_missing_file_and_a_folder_are_told(tmp_path):
    assert "does not exist" in plugins.load(tmp_path / "no.py").faults[0]
    assert "is a folder" in plugins.load(tmp_path).faults[0]


def test_the_configuration_lists_files_beside_it(config, tmp_path):
    path = config('[plugins]\nfiles = ["one.py", "/two.py", "~/three.py"]')

    read = plugins.configuration()

    assert read.path == path
    assert read.files[0] == tmp_path / "one.py"
    assert str(read.files[2])[0] != "~"
    assert read.faults == ()


def test_without_a_configuration_there_are_no_files(monkeypatch, tmp_path):
    monkeypatch.delenv(plugins.CONFIG)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))

    read = plugins.configuration()

    assert (read.files, read.faults) == ((), ())
    assert read.path.parts[-2:] == ("regframe", "config.toml")


def test_the_working_folder_is_no_place_for_a_configuration(monkeypatch, tmp_path):
    monkeypatch.delenv(plugins.CONFIG)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "settings"))
    monkeypatch.chdir(tmp_path)
    for name in ("config.toml", "regframe.toml", "regframe/config.toml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text('[plugins]\nfiles = ["stranger.py"]')

    assert plugins.configuration().files == ()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[plugins", "cannot be read"),
        ("[plugin]\nfiles = []", "unknown key 'plugin'. Did you mean 'plugins'?"),
        ("[plugins]\nfile = []", "unknown key 'plugins.file'. Did you mean 'plugins.files'?"),
        ('[plugins]\nfiles = "a.py"', "plugins.files must be a list of paths in quotes. Got 'a.py'."),
        ("plugins = 3", "plugins.files must be a list of paths in quotes. Got 3."),
    ],
)
def test_a_faulty_configuration_is_told(text, words, config):
    config(text)

    read = plugins.configuration()

    assert words in read.faults[0]
    assert read.files == ()


def test_a_configuration_that_is_not_there_is_told(monkeypatch):
    monkeypatch.setenv(plugins.CONFIG, "not/there.toml")

    assert "REGFRAME_CONFIG names 'not/there.toml', which does not exist." in plugins.configuration().faults


@pytest.mark.parametrize(
    "name", ["mine.py", "./mine.py", "folder/mine.py", "mine.py:Mine", "os:system", "a\\b"]
)
def test_a_preset_that_names_code_is_refused_and_nothing_is_run(name, file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file("raise SystemExit('the stranger was run')")

    with pytest.raises(PresetError, match="names code, and a preset cannot run any") as caught:
        load_preset("paper-similarity", {"stages.0.metric": name})

    assert "--plugin FILE" in str(caught.value)
    assert "stages.0.metric" in str(caught.value)


@pytest.mark.parametrize("key", ["plugin", "plugins"])
def test_a_preset_that_lists_plugins_is_refused(key):
    with pytest.raises(PresetError, match="a preset cannot load plugins: it may come from a stranger"):
        parse({"extends": "paper-similarity", key: {"files": ["mine.py"]}})
