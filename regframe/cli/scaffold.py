"""The files of a new plugin: a distribution with one component, its preset and its tests."""

import re
from importlib.metadata import distributions
from pathlib import Path
from secrets import token_hex
from string import Template

from regframe.catalog import of_kind
from regframe.errors import OutputError, PresetError
from regframe.io import atomic
from regframe.registry import AnyRegistry

TEMPLATES = Path(__file__).with_name("templates")
NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")
SETTINGS = {
    "metric": '"stages.0.metric" = "{}"',
    "transform": '"stages.0.transform" = "{}"',
    "interpolator": '"stages.0.interpolator" = "{}"',
    "optimizer": '"stages.0.optimizer" = "{}"',
    "filter": 'filters.moving = ["{}"]',
}
IMPORTED = frozenset({"ClassVar", "Field", "Generator", "Literal"})


def plugin(kind: str, name: str) -> dict[str, str]:
    """Every file of a new distribution, by its path in the folder.

    Parameters
    ----------
    kind : str
        metric, transform, interpolator, optimizer or filter.
    name : str
        What presets will call it, in kebab-case.

    Raises
    ------
    PresetError
        No such kind, a name that no component may have, or one that is taken.

    Examples
    --------
    >>> sorted(plugin("metric", "my-metric"))[:2]
    ['README.md', 'pyproject.toml']
    """
    registry = of_kind(kind)
    _check(registry, name)
    words = _words(registry, name)
    module, snake, preset = words["module"], words["snake"], words["preset"]
    return {
        "README.md": _filled("README.md", words),
        "pyproject.toml": _filled("pyproject.toml", words),
        f"{module}/__init__.py": _filled(f"{registry.kind}.py", words),
        f"{module}/{preset}.toml": _filled("preset.toml", words),
        f"tests/test_{snake}.py": _filled("test.py", words),
    }


def write(files: dict[str, str], folder: Path, *, force: bool) -> None:
    """Make the folder whole or not at all; with `force`, replace these files in one that is there.

    Raises
    ------
    OutputError
        The folder is there and `force` is off, or it cannot be made.
    """
    if folder.exists() and not (force and folder.is_dir()):
        hint = "Name another with --out, or add --force to replace the plugin's files in it."
        if not folder.is_dir():
            hint = "Name another with --out."
        message = f"{str(folder)!r} exists already. {hint}"
        raise OutputError(message)
    try:
        if folder.exists():
            _write_each(files, folder)
            return
        folder.parent.mkdir(parents=True, exist_ok=True)
        made = folder.with_name(f".{token_hex(4)}.{folder.name}")
        _write_each(files, made)
        made.rename(folder)
    except OSError as error:
        message = f"cannot make {str(folder)!r}: {error.strerror}. Name another folder with --out."
        raise OutputError(message) from None


def _write_each(files: dict[str, str], folder: Path) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        with atomic(folder / name) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _check(registry: AnyRegistry, name: str) -> None:
    if not NAME.fullmatch(name):
        better = "-".join(re.findall(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])", name)).lower()
        better = better if NAME.fullmatch(better) else f"my-{registry.kind}"
        message = (
            f"a name is small letters and digits, words joined by '-', a letter first. Got {name!r}. "
            f"Write {better!r}."
        )
        raise PresetError(message)
    if name in registry.names():
        message = (
            f"{name!r} is already the name of a {registry.kind} ({registry.origin(name)}). Choose another."
        )
        raise PresetError(message)
    taken = {found.name.lower().replace("_", "-") for found in distributions() if found.name}
    if f"regframe-{name}" in taken:
        message = f"a distribution 'regframe-{name}' is installed. Choose another name, or uninstall it."
        raise PresetError(message)


def _words(registry: AnyRegistry, name: str) -> dict[str, str]:
    """What the templates' blanks are filled with."""
    import regframe

    class_name = "".join(part.capitalize() for part in name.split("-"))
    if class_name in IMPORTED or class_name in regframe.__all__:
        class_name += registry.kind.capitalize()
    snake = name.replace("-", "_")
    article = "An" if registry.kind[0] in "aeiou" else "A"
    return {
        "kind": registry.kind,
        "kinds": f"{registry.kind}s",
        "article_kind": f"{article} {registry.kind}",
        "name": name,
        "snake": snake,
        "class_name": class_name,
        "module": f"regframe_{snake}",
        "distribution": f"regframe-{name}",
        "preset": f"{name}-example",
        "description": f"{article} {registry.kind} for regframe: {name}.",
        "extra": ', "scipy"' if registry.kind == "interpolator" else "",
        "setting": SETTINGS[registry.kind].format(name),
    }


def _filled(template: str, words: dict[str, str]) -> str:
    return Template((TEMPLATES / f"{template}.txt").read_text(encoding="utf-8")).substitute(words)
