"""Generated pages are those that the code makes today."""

from importlib.util import module_from_spec, spec_from_file_location

import pytest

from house.source import REPOSITORY
from regframe.catalog import KINDS

DOCS = REPOSITORY / "docs"


@pytest.fixture(scope="module")
def generate():
    spec = spec_from_file_location("generate", DOCS / "generate.py")
    assert spec is not None
    assert spec.loader is not None
    generate = module_from_spec(spec)
    spec.loader.exec_module(generate)
    return generate


def test_components_page_is_up_to_date(generate):
    assert generate.PAGE.read_text(encoding="utf-8") == generate.page(), "run `make docs`"


@pytest.mark.parametrize("kind", ["metric", "transform", "interpolator", "optimizer", "filter"])
def test_page_of_a_kind_shows_a_plugins_file_as_it_is(generate, kind):
    (page,) = (path for path in generate.GUIDES if path.stem in (f"write-a-{kind}", f"write-an-{kind}"))
    text = page.read_text(encoding="utf-8")

    (found,) = generate.INCLUDED.finditer(text)

    assert (REPOSITORY / found[2]).read_text(encoding="utf-8") in text


def test_files_that_pages_show_are_up_to_date(generate):
    old = [page.name for page in generate.GUIDES if page.read_text(encoding="utf-8") != generate.guide(page)]

    assert old == [], "run `make docs`"


def test_every_shipped_component_has_its_section():
    text = (DOCS / "reference" / "components.md").read_text(encoding="utf-8")

    missing = [
        name
        for registry in KINDS.values()
        for name in registry.names()
        if registry.origin(name) == "regframe" and f"### {name}\n" not in text
    ]

    assert missing == []
