"""A JSON schema of presets, so that editors complete and check them."""

from typing import Any

from regframe.catalog import KINDS
from regframe.preset.model import Preset
from regframe.registry import REFERENCE

DIALECT = "https://json-schema.org/draft/2020-12/schema"
DOTTED = r"^(filters|stages)(\.[A-Za-z0-9_]+)+$"


def schema() -> dict[str, object]:
    """JSON schema of a preset file; ``#:schema file.json`` as its first line tells TOML editors.

    Every component that can be imported is in it, plugins and those of this session too.

    Examples
    --------
    >>> "stages" in schema()["properties"]
    True
    """
    tree = Preset.model_json_schema()
    for registry in KINDS.values():
        tree["$defs"] |= registry.schemas()
    tree["properties"]["extends"] = {
        "type": "string",
        "description": "A shipped preset's name, or a path ending in .toml: this file changes its values.",
    }
    tree["patternProperties"] = {DOTTED: {"description": "A new value at that path of the extended preset."}}
    tree["anyOf"] = [{"required": tree.pop("required")}, {"required": ["extends"]}]
    return {"$schema": DIALECT, **_referred(tree)}


def _referred(node: Any) -> Any:
    """The tree with every unfinished reference to a kind finished."""
    if isinstance(node, list):
        return [_referred(entry) for entry in node]
    if not isinstance(node, dict):
        return node
    if REFERENCE in node:
        others = {key: value for key, value in node.items() if key != REFERENCE}
        return {"$ref": f"#/$defs/{node[REFERENCE]}", **others}
    return {key: _referred(value) for key, value in node.items()}
