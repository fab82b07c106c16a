"""Write the pages that are made from the code: `make docs`."""

import re
from inspect import cleandoc
from pathlib import Path

from pydantic.fields import FieldInfo

from regframe.catalog import KINDS
from regframe.component import Component
from regframe.peer import agreement, settings

PAGE = Path(__file__).parent / "reference" / "components.md"
AGREEMENT = Path(__file__).parent / "explanation" / "agreement.md"
GUIDES = sorted((Path(__file__).parent / "how-to").glob("*.md"))
INCLUDED = re.compile(
    r"(<!-- the file (\S+), by `make docs`(?:, as \S+)? -->\n```python\n).*?^(```\n)",
    re.DOTALL | re.MULTILINE,
)
MADE = "<!-- made from here by `make docs` -->\n"

HEAD = """\
# Components

Made by `make docs` from the code. In a preset, a component is its name, or a table with `type` and options:
`metric = {type = "mattes", bins = 32}`. `regframe explain NAME` prints the same in a terminal.
"""


def page() -> str:
    """The reference page of all components that regframe ships."""
    sections = [HEAD]
    for kind, registry in KINDS.items():
        sections.append(f"## {kind.capitalize()}\n")
        shipped = [name for name in registry.names() if registry.origin(name) == "regframe"]
        sections += [entry(name, registry[name]) for name in shipped]
    return "\n".join(sections)


def entry(name: str, cls: type[Component]) -> str:
    """A component's section: what it is, and a table of its options."""
    rows = [row(option, field) for option, field in cls.model_fields.items()]
    head = ["| option | default | meaning |", "|---|---|---|"]
    table = "\n".join([*head, *rows]) if rows else "No options."
    return f"### {name}\n\n{cleandoc(cls.__doc__ or '')}\n\n{table}\n"


def row(option: str, field: FieldInfo) -> str:
    """One option's line in the table."""
    default = (
        "required" if field.is_required() else f"`{plain(field.get_default(call_default_factory=True))}`"
    )
    meaning = (field.description or "").replace("|", "\\|")
    return f"| `{option}` | {default} | {meaning} |"


def plain(value: object) -> str:
    """A default as a preset would say it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return f"[{', '.join(map(plain, value))}]"
    return f'"{value}"' if isinstance(value, str) else "none" if value is None else f"{value}"


def agreement_page() -> str:
    """The page on agreement with SimpleITK: its text as it stands, its tables measured now."""
    text, _, _ = AGREEMENT.read_text(encoding="utf-8").partition(MADE)
    return f"{text}{MADE}\n{agreement.table({'settings': settings.rows()})}"


def guide(path: Path) -> str:
    """A page whose text stands, with the plugin's file that it names put in."""
    root = Path(__file__).parents[1]

    def included(found: re.Match[str]) -> str:
        return found[1] + (root / found[2]).read_text(encoding="utf-8") + found[3]

    return INCLUDED.sub(included, path.read_text(encoding="utf-8"))


if __name__ == "__main__":
    for page_of_kind in GUIDES:
        page_of_kind.write_text(guide(page_of_kind), encoding="utf-8")
    PAGE.write_text(page(), encoding="utf-8")
    AGREEMENT.write_text(agreement_page(), encoding="utf-8")
