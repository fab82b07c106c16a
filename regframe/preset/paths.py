"""Paths into a preset's tree: `stages.0.metric.bins` changed and compared."""

from collections.abc import Iterator
from typing import Any

from regframe.catalog import KINDS
from regframe.errors import PresetError
from regframe.faults import nearest
from regframe.preset.model import Preset, dump

Change = tuple[str, object, object]


def change(tree: Any, path: str, value: object) -> None:
    """Put a value at a path of a resolved tree, in place.

    A list takes one entry more at the index after its last; a component given by its name alone becomes
    a table; a component's new `type` drops the old one's options. Whether the last key of a table exists
    is left to the validation that follows, which knows every option.

    Raises
    ------
    PresetError
        The path leads nowhere; the message is the fault's text.
    """
    *way, last = path.split(".")
    node = tree
    for key in way:
        node = _entered(node, key, tree, path)
    if isinstance(node, list):
        _change_list(node, last, value, tree, path)
    elif not isinstance(node, dict):
        raise PresetError(_no_path(tree, path))
    elif last == "type" and node.get("type") != value:
        node.clear()
        node["type"] = value
    else:
        node[last] = value


def paths(tree: object, before: str = "") -> Iterator[str]:
    """Every path of a tree, parents before children."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        path = f"{before}{key}"
        yield path
        yield from paths(value, f"{path}.")


def differences(a: Preset, b: Preset) -> list[Change]:
    """What a preset `b` says otherwise than `a`, whichever way either was written.

    Returns
    -------
    list of (path, old, new)
        None stands for "not there". A component of another type is one difference.

    Examples
    --------
    >>> from regframe.preset import load
    >>> differences(load("paper-similarity"), load("paper-similarity", {"seed": 3}))
    [('seed', 1, 3)]
    """
    return list(_differences(dump(a), dump(b), ""))


def _differences(old: Any, new: Any, path: str) -> Iterator[Change]:
    pairs: list[tuple[str, Any, Any]]
    if isinstance(old, dict) and isinstance(new, dict) and old.get("type") == new.get("type"):
        pairs = [(key, old.get(key), new.get(key)) for key in {**old, **new}]
    elif _hold_tables(old, new):
        longest = range(max(len(old), len(new)))
        pairs = [(str(i), _entry(old, i), _entry(new, i)) for i in longest]
    else:
        if old != new:
            yield path, old, new
        return
    for key, before, after in pairs:
        yield from _differences(before, after, f"{path}.{key}" if path else key)


def _hold_tables(old: Any, new: Any) -> bool:
    """Whether both are lists of tables (stages, levels, filters); lists of numbers differ as a whole."""
    both = isinstance(old, list) and isinstance(new, list)
    return both and any(isinstance(entry, dict) for entry in (*old, *new))


def _entry(entries: list[Any], index: int) -> Any:
    return entries[index] if index < len(entries) else None


def _entered(node: Any, key: str, tree: Any, path: str) -> Any:
    """What stands at a key of a node; a component's bare name is made a table first."""
    at: Any = int(key) if isinstance(node, list) and key.isdecimal() else key
    known = at in node if isinstance(node, dict) else isinstance(at, int) and at < len(node)
    if not known:
        raise PresetError(_no_path(tree, path))
    # Only filters stand in lists by their bare name.
    if isinstance(node[at], str) and (isinstance(at, int) or at in _kinds()):
        node[at] = {"type": node[at]}
    return node[at]


def _kinds() -> set[str]:
    return {registry.kind for registry in KINDS.values()}


def _change_list(node: list[Any], last: str, value: object, tree: Any, path: str) -> None:
    if not last.isdecimal() or int(last) > len(node):
        known = f" It has {len(node)}; write {len(node)} to add one." if last.isdecimal() else ""
        raise PresetError(_no_path(tree, path) + known)
    node[int(last) : int(last) + 1] = [value]


def _no_path(tree: Any, path: str) -> str:
    near = nearest(path, paths(tree))
    return f"there is no such path.{near or ' `regframe preset show` prints all of them.'}"
