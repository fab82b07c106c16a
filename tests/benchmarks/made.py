"""Measured parts of the documents, between two marks."""

from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def put(page: Path, name: str, text: str) -> None:
    """Replace what stands between a page's marks ``<!-- name: measured -->`` and ``<!-- name: end -->``."""
    whole = page.read_text(encoding="utf-8")
    begin, end = f"<!-- {name}: measured -->\n", f"<!-- {name}: end -->"
    before, first, rest = whole.partition(begin)
    _, last, after = rest.partition(end)
    if not (first and last):
        message = f"{page} lacks the marks of {name!r}. Write {begin.strip()} and {end.strip()} there."
        raise ValueError(message)
    new = page.with_suffix(".new")
    new.write_text(f"{before}{begin}{text}\n{end}{after}", encoding="utf-8")
    new.replace(page)


def table(rows: Iterable[list[str]]) -> str:
    """Rows in Markdown, the first one as heads."""
    heads, *rest = rows
    return "\n".join(f"| {' | '.join(row)} |" for row in (heads, ["---"] * len(heads), *rest))
