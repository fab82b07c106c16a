"""The source tree as the house rules see it."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PACKAGE = REPOSITORY / "regframe"
PLUGINS = {path.parent.name: path for path in (REPOSITORY / "plugins").glob("*/regframe_*/__init__.py")}


def modules() -> list[str]:
    """Dotted name of every module of regframe, sorted."""
    return sorted(_dotted(path) for path in PACKAGE.rglob("*.py"))


def plugins() -> list[str]:
    """Name of every plugin's one module, sorted."""
    return sorted(PLUGINS)


def path_of(module: str) -> Path:
    """The file of a module."""
    if module in PLUGINS:
        return PLUGINS[module]
    inner = PACKAGE.joinpath(*module.split(".")[1:])
    return inner / "__init__.py" if inner.is_dir() else inner.with_suffix(".py")


@cache
def tree(module: str) -> ast.Module:
    """The syntax tree of a module."""
    return ast.parse(path_of(module).read_text(encoding="utf-8"))


def functions(module: str) -> Iterator[tuple[str, ast.FunctionDef]]:
    """Every function and method with its qualified name."""
    yield from _functions(tree(module), module)


def imports(module: str) -> Iterator[tuple[str, str]]:
    """What a module imports when it runs, and in which function ('' at the top)."""
    yield from _imports(tree(module), "", module.rpartition(".")[0])


def _dotted(path: Path) -> str:
    parts = path.relative_to(REPOSITORY).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _functions(node: ast.AST, within: str) -> Iterator[tuple[str, ast.FunctionDef]]:
    for child in ast.iter_child_nodes(node):
        inner = f"{within}.{child.name}" if isinstance(child, ast.ClassDef | ast.FunctionDef) else within
        if isinstance(child, ast.FunctionDef):
            yield inner, child
        yield from _functions(child, inner)


def _imports(node: ast.AST, within: str, package: str) -> Iterator[tuple[str, str]]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            continue
        if isinstance(child, ast.Import):
            yield from ((alias.name, within) for alias in child.names)
        elif isinstance(child, ast.ImportFrom):
            source = child.module or package
            yield from ((_module_or_name(source, alias.name), within) for alias in child.names)
        name = child.name if isinstance(child, ast.ClassDef | ast.FunctionDef) else ""
        yield from _imports(child, f"{within}.{name}".strip(".") if name else within, package)


def _module_or_name(source: str, name: str) -> str:
    """`from regframe.kernels import linear` imports the module regframe.kernels.linear."""
    inner = f"{source}.{name}"
    if source.split(".", maxsplit=1)[0] == "regframe" and path_of(inner).is_file():
        return inner
    return source
