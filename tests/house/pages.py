"""Documents taken apart into code blocks.

A block runs unless the line before it says ``<!-- not run: the reason -->``. A block whose first line is
a comment with a file name (``# mine.toml``) is written to that file as well, and so is a plugin's file
that the page shows, if the line before it says ``<!-- the file ..., by `make docs`, as FILE -->``.
"""

import re
from dataclasses import dataclass
from pathlib import Path

from house.source import REPOSITORY

BLOCK = re.compile(
    r"(?:<!-- not run: (?P<reason>[^\n]+?) -->\n+)?"
    r"(?:<!-- the file [^\n]+, as (?P<shown>\S+) -->\n)?"
    r"^```(?P<language>[a-z]*)\n(?P<code>.*?)^```$",
    re.DOTALL | re.MULTILINE,
)
RUNNABLE = ("bash", "console", "python", "sh", "toml")


@dataclass(frozen=True)
class Block:
    """A fenced block of code."""

    language: str
    code: str
    reason: str | None
    line: int
    shown: str | None = None

    @property
    def file(self) -> str | None:
        """The file that the block's first line names, or the line before it."""
        found = re.match(r"# ((?:[\w-]+/)*[\w.-]+\.(?:py|toml))\n", self.code)
        return found[1] if found else self.shown


def pages() -> list[Path]:
    """Every document, but for decisions' and news' quotations of code: they tell of their day."""
    found = [REPOSITORY / "README.md", REPOSITORY / "CONTRIBUTING.md", *(REPOSITORY / "docs").rglob("*.md")]
    return sorted(found)


def blocks(page: Path) -> list[Block]:
    """The code blocks of a page that are in a language we can run."""
    text = page.read_text(encoding="utf-8")
    return [
        Block(
            found["language"],
            found["code"],
            found["reason"],
            text[: found.start("language")].count("\n") + 1,
            found["shown"],
        )
        for found in BLOCK.finditer(text)
        if found["language"] in RUNNABLE
    ]
