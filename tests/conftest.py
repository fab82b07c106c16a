"""What all tests share: where the real data are, and how hypothesis runs."""

import os
import sys
from pathlib import Path

import pytest
from hypothesis import settings

REPOSITORY = Path(__file__).resolve().parents[1]
DATA = Path(os.environ.get("REGFRAME_DATA", REPOSITORY.parent / "shared" / "data"))

# Explicit seeds, and no deadline, because the first call of a kernel compiles it.
settings.register_profile("regframe", derandomize=True, deadline=None, database=None, max_examples=50)
settings.load_profile("regframe")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark every test that uses the real data, so that `-m "not realdata"` needs no discipline."""
    for item in items:
        if "data" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.realdata)


@pytest.fixture(scope="session", autouse=True)
def configuration(tmp_path_factory) -> Path:
    """An empty configuration, so that nobody's own plugins take part in the tests."""
    file = tmp_path_factory.mktemp("configuration") / "config.toml"
    file.touch()
    os.environ["REGFRAME_CONFIG"] = str(file)
    return file


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of real images; without it the test is skipped."""
    if not (DATA / "pairs.csv").is_file():
        pytest.skip("the real images are not here: set REGFRAME_DATA to their folder")
    return DATA


@pytest.fixture
def forgotten():
    """What a test registers, or loads from a plugin's file, is taken back."""
    from regframe import plugins
    from regframe.catalog import KINDS

    yield
    for registry in KINDS.values():
        for name in registry.added():
            registry.forget(name)
    for name in [name for name in sys.modules if name.startswith(plugins.FILE_MODULE)]:
        del sys.modules[name]
