"""Presets in and out: shipped names, TOML files, `extends`, overrides by path."""

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import ValidationError

from regframe.errors import PresetError
from regframe.faults import lines, nearest, shown
from regframe.io import atomic, refuse_existing
from regframe.preset.finding import names, place
from regframe.preset.model import Preset, dump
from regframe.preset.paths import change

Tree = dict[str, Any]


def load(source: str | Path | Preset, overrides: Mapping[str, object] | None = None) -> Preset:
    """A preset by its name or from a TOML file, with values changed by path.

    Parameters
    ----------
    source : str, Path or Preset
        A name, shipped or a plugin's, a path (it ends in ``.toml``), or a preset as it is.
    overrides : mapping of str to object, optional
        Applied in order: ``{"stages.0.metric": "mattes", "stages.0.metric.bins": 32}``.

    Raises
    ------
    PresetError
        Nothing of that name, or faults: all of them, one a line, after a line that names the preset.

    Examples
    --------
    >>> load("paper-similarity", {"stages.0.metric.bins": 32}).stages[0].metric.bins
    32
    """
    preset = source if isinstance(source, Preset) else _read(_find(source, Path()), ())
    if not overrides:
        return preset
    return _changed(dump(preset), overrides, f"preset {preset.name!r} with overrides")


def parse(tree: Mapping[str, object]) -> Preset:
    """A preset from tables, lists and values, as a file holds them: `extends` and paths work too.

    Parameters
    ----------
    tree : mapping
        What `dump` gives, or ``{"extends": "paper-similarity", "stages.0.metric.bins": 32}``.

    Raises
    ------
    PresetError
        Every fault, one a line.

    Examples
    --------
    >>> parse({"extends": "paper-similarity", "stages.0.transform": "affine"}).stages[0].transform
    Affine()
    """
    return _grown(tree, str(tree.get("name", "unnamed")), Path(), (), "")


def as_toml(preset: Preset) -> str:
    """The whole preset as TOML, every default written out.

    Raises
    ------
    PresetError
        TOML cannot say it: an option is None and its default is not, or is no number (NaN).

    Examples
    --------
    >>> print(as_toml(load("paper-similarity")).splitlines()[0])
    name = "paper-similarity"
    """
    tree = _without_none(dump(preset))
    if parse(tree) != preset:
        message = (
            f"preset {preset.name!r} holds a value that TOML cannot say: an option set to None or NaN. "
            "Give it another value."
        )
        raise PresetError(message)
    return tomli_w.dumps(tree)


def save(preset: Preset, path: str | Path, *, force: bool = False) -> None:
    """Write a preset as TOML, resolved, whole or not at all.

    Parameters
    ----------
    force : bool
        Overwrite what is there.

    Raises
    ------
    OutputError
        The file exists and `force` is off, or its folder cannot be written.
    """
    target = Path(path)
    text = as_toml(preset)
    refuse_existing(target, force)
    with atomic(target) as temporary:
        temporary.write_text(text, encoding="utf-8")


def setting(text: str) -> tuple[str, object]:
    """Path and value of a command line's ``path=value``: the value is TOML, or else plain text.

    Raises
    ------
    PresetError
        There is no ``=``, or nothing on one of its sides.

    Examples
    --------
    >>> setting("stages.0.metric.bins=32"), setting("stages.0.start=moments")
    (('stages.0.metric.bins', 32), ('stages.0.start', 'moments'))
    """
    path, _, value = (part.strip() for part in text.partition("="))
    if not path or not value:
        message = f"a setting is path=value. Got {text!r}. Write stages.0.metric.bins=32."
        raise PresetError(message)
    try:
        return path, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return path, value


def _find(source: str | Path, beside: Path) -> Path:
    """The file of a name or path; paths start `beside`."""
    if isinstance(source, Path) or source.endswith(".toml") or "/" in source or "\\" in source:
        return beside / Path(source).expanduser()
    found = place(source)
    if found is not None:
        return found
    file = beside / f"{source}.toml"
    hint = f"To read the file, write {file.name!r}." if file.is_file() else "A file's name ends in .toml."
    known = names()
    message = (
        f"no preset is called {source!r}.{nearest(source, known)} "
        f"`regframe list presets` names all {len(known)}. {hint}"
    )
    raise PresetError(message)


def _read(path: Path, before: tuple[Path, ...]) -> Preset:
    """The preset of a file, with all it extends; `before` are the files that lead here by `extends`."""
    place = path.resolve()
    if place in before:
        circle = " extends ".join(repr(file.stem) for file in (*before[before.index(place) :], place))
        message = f"preset {path.stem!r} extends itself: {circle}. Break the circle."
        raise PresetError(message)
    return _grown(_toml(path), path.stem, path.parent, (*before, place), f" ({path.name})")


def _grown(
    tree: Mapping[str, object], name: str, beside: Path, before: tuple[Path, ...], file: str
) -> Preset:
    """The preset of a tree: its base, its own keys over that, its paths last."""
    title = f"preset {tree.get('name', name)!r}{file}"
    base = _base(tree["extends"], beside, before, title) if "extends" in tree else {}
    inside = {key: value for key, value in tree.items() if "." in key}
    whole = {key: value for key, value in tree.items() if "." not in key and key != "extends"}
    # What a preset is called and is about does not hold for one that changes it.
    grown = {**base, "name": name, "about": "", **whole}
    filters = whole.get("filters")
    if isinstance(filters, Mapping):
        grown["filters"] = {**base.get("filters", {}), **filters}
    return _changed(grown, inside, title)


def _base(extends: object, beside: Path, before: tuple[Path, ...], title: str) -> Tree:
    """The resolved tree of what `extends` says."""
    if not isinstance(extends, str):
        message = f"{title}:\nextends: must be a preset's name or a file in quotes. Got {shown(extends)}."
        raise PresetError(message)
    try:
        found = _find(extends, beside)
    except PresetError as error:
        message = f"{title}:\nextends: {error}"
        raise PresetError(message) from None
    return dump(_read(found, before))


def _changed(tree: Tree, overrides: Mapping[str, object], title: str) -> Preset:
    """The preset of a tree after the overrides; faults of both together."""
    if not overrides:
        return _validated(tree, title, [])
    # Paths are looked up where every default is written out.
    resolved = dump(_validated(tree, title, []))
    faults = []
    for path, value in overrides.items():
        try:
            change(resolved, path, value)
        except PresetError as error:
            faults.append(f"{path}: {error}")
    return _validated(resolved, title, faults)


def _validated(tree: Tree, title: str, faults: list[str]) -> Preset:
    preset = None
    try:
        preset = Preset.model_validate(tree)
    except ValidationError as error:
        faults = [*faults, *lines(error, Preset)]
    if preset is None or faults:
        raise PresetError("\n".join([f"{title}:", *faults]))
    return preset


def _toml(path: Path) -> Tree:
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        near = nearest(path.name, [file.name for file in path.parent.glob("*.toml")])
        message = f"there is no preset file {str(path)!r}.{near}"
        raise PresetError(message) from None
    except (OSError, UnicodeDecodeError) as error:
        message = f"the preset file {str(path)!r} cannot be read: {error}. A preset is TOML text in UTF-8."
        raise PresetError(message) from None
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise PresetError(_syntax(path, text, str(error))) from None


def _syntax(path: Path, text: str, error: str) -> str:
    """File, line, what is wrong there, and the line."""
    title = f"preset {path.stem!r} ({path.name}) is not TOML:"
    what = re.sub(r"\s*\(at .*\)$", "", error)
    found = re.search(r"\(at line (\d+), column (\d+)\)", error)
    if found is None:
        return f"{title}\nat its end: {what}."
    met = [*text.splitlines(), ""][int(found[1]) - 1]
    return f"{title}\nline {found[1]}, column {found[2]}: {what}. Got {shown(met.strip())}."


def _without_none(tree: Any) -> Any:
    if isinstance(tree, dict):
        return {key: _without_none(value) for key, value in tree.items() if value is not None}
    return [_without_none(value) for value in tree] if isinstance(tree, list) else tree
