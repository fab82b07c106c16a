"""As much of JSON Schema 2020-12 as the schema of presets uses, to see that it says what the models say."""

import re
from collections.abc import Mapping
from typing import Any

TYPES = {
    "array": list,
    "boolean": bool,
    "integer": int,
    "null": type(None),
    "number": (int, float),
    "object": Mapping,
    "string": str,
}
LIMITS = {
    "minimum": lambda met, limit: met >= limit,
    "maximum": lambda met, limit: met <= limit,
    "exclusiveMinimum": lambda met, limit: met > limit,
    "exclusiveMaximum": lambda met, limit: met < limit,
}
SIZES = {
    "minItems": lambda met, limit: len(met) >= limit,
    "maxItems": lambda met, limit: len(met) <= limit,
    "minLength": lambda met, limit: len(met) >= limit,
}
NOTES = {"$defs", "$schema", "default", "description", "examples", "title"}
CHECKED = {
    "$ref", "additionalProperties", "anyOf", "const", "enum", "items", "patternProperties", "prefixItems",
    "properties", "required", "type", *LIMITS, *SIZES,
}  # fmt: skip


def valid(met: Any, schema: Mapping[str, Any], root: Mapping[str, Any]) -> bool:
    """Whether a value satisfies a schema; `root` holds the definitions."""
    unknown = schema.keys() - NOTES - CHECKED
    assert not unknown, f"teach this checker {unknown}"
    if "$ref" in schema:
        target = root["$defs"][schema["$ref"].removeprefix("#/$defs/")]
        if not valid(met, target, root):
            return False
    return (
        ("type" not in schema or _is(met, schema["type"]))
        and ("const" not in schema or met == schema["const"])
        and ("enum" not in schema or met in schema["enum"])
        and ("anyOf" not in schema or any(valid(met, each, root) for each in schema["anyOf"]))
        and _within(met, schema)
        and (not isinstance(met, Mapping) or _valid_table(met, schema, root))
        and (not isinstance(met, list) or _valid_list(met, schema, root))
    )


def _is(met: Any, name: str) -> bool:
    return isinstance(met, TYPES[name]) and (name == "boolean" or not isinstance(met, bool))


def _within(met: Any, schema: Mapping[str, Any]) -> bool:
    tests = LIMITS if isinstance(met, int | float) else SIZES if isinstance(met, str | list) else {}
    return all(test(met, schema[word]) for word, test in tests.items() if word in schema)


def _valid_table(met: Mapping[str, Any], schema: Mapping[str, Any], root: Mapping[str, Any]) -> bool:
    if any(key not in met for key in schema.get("required", [])):
        return False
    for key, value in met.items():
        known = [schema["properties"][key]] if key in schema.get("properties", {}) else []
        known += [each for mask, each in schema.get("patternProperties", {}).items() if re.search(mask, key)]
        if not known and schema.get("additionalProperties") is False:
            return False
        if not all(valid(value, each, root) for each in known):
            return False
    return True


def _valid_list(met: list[Any], schema: Mapping[str, Any], root: Mapping[str, Any]) -> bool:
    first = schema.get("prefixItems", [])
    rest = schema.get("items", {})
    return all(valid(value, each, root) for value, each in zip(met, first, strict=False)) and all(
        valid(value, rest, root) for value in met[len(first) :]
    )
