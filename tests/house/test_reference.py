"""Generated pages are those that the code makes today."""

from importlib.util import module_from_spec, spec_from_file_location

from house.source import REPOSITORY
from regframe.catalog import KINDS

DOCS = REPOSITORY / "docs"


def test_components_page_is_up_to_date():
    spec = spec_from_file_location("generate", DOCS / "generate.py")
    assert spec is not None
    assert spec.loader is not None
    generate = module_from_spec(spec)
    spec.loader.exec_module(generate)

    assert generate.PAGE.read_text(encoding="utf-8") == generate.page(), "run `make docs`"


def test_every_shipped_component_has_its_section():
    text = (DOCS / "reference" / "components.md").read_text(encoding="utf-8")

    missing = [
        name
        for registry in KINDS.values()
        for name in registry.names()
        if registry.origin(name) == "regframe" and f"### {name}\n" not in text
    ]

    assert missing == []
