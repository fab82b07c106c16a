"""Count lines of code, without blank lines, comments and docstrings: ``python docs/count_lines.py FILE ...``.

Python and Cython by their tokens, C++ by taking its comments away. ``FILE:Class``
counts one class.
"""

import ast
import io
import re
import sys
import tokenize
from pathlib import Path

C_COMMENT = re.compile(r'"(?:\\.|[^"\\])*"|//[^\n]*|/\*.*?\*/', re.DOTALL)
CYTHON = re.compile(r'[rRuU]?("""|\'\'\').*?\1|#[^\n]*', re.DOTALL)
SILENT = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}


def count(name: str) -> int:
    """Lines of code of a file, or of one class in it."""
    path, _, within = name.partition(":")
    text = Path(path).read_text(encoding="utf-8", errors="replace")
    if path.endswith(".py"):
        return len(_python_lines(text, within))
    kept = CYTHON.sub("", text) if path.endswith((".pyx", ".pxd")) else C_COMMENT.sub(_kept, text)
    return sum(1 for line in kept.splitlines() if line.strip())


def _kept(found: re.Match[str]) -> str:
    """A string of C++ as it is; of a comment, its line breaks."""
    return found[0] if found[0].startswith('"') else "\n" * found[0].count("\n")


def _python_lines(text: str, within: str) -> set[int]:
    tree = ast.parse(text)
    nodes = list(ast.walk(tree))
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    silent: set[int] = set()
    for node in nodes:
        if isinstance(node, documented) and ast.get_docstring(node, clean=False) is not None:
            silent |= set(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in SILENT:
            lines |= set(range(token.start[0], token.end[0] + 1))
    if within:
        (place,) = [node for node in nodes if isinstance(node, ast.ClassDef) and node.name == within]
        lines &= set(range(place.lineno, (place.end_lineno or 0) + 1))
    return lines - silent


if __name__ == "__main__":
    counts = {name: count(name) for name in sys.argv[1:]}
    for name, lines in counts.items():
        sys.stdout.write(f"{lines:6} {name}\n")
    sys.stdout.write(f"{sum(counts.values()):6} in all\n")
