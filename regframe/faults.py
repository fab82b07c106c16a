"""What is wrong with a configuration, one line a fault: path, what, the value met, what to do."""

import difflib
import json
from collections.abc import Iterable, Iterator
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

Location = tuple[int | str, ...]

LONGEST = 80
"""Characters of a met value that a fault shows."""

_WORDS = {
    "bool_type": "must be true or false",
    "dict_type": "must be a table",
    "finite_number": "must be a finite number",
    "float_type": "must be a number",
    "int_from_float": "must be a whole number",
    "int_type": "must be a whole number",
    "list_type": "must be a list",
    "model_type": "must be a table",
    "string_type": "must be text in quotes",
    "tuple_type": "must be a list",
}

_LIMITS = {
    "greater_than": ("must be greater than", "gt"),
    "greater_than_equal": ("must be at least", "ge"),
    "less_than": ("must be less than", "lt"),
    "less_than_equal": ("must be at most", "le"),
    "string_too_short": ("has too few characters: at least", "min_length"),
    "too_long": ("has too many entries: at most", "max_length"),
    "too_short": ("has too few entries: at least", "min_length"),
}


def nearest(word: str, known: Iterable[str]) -> str:
    """`` Did you mean 'x'?`` where a known word is near, else an empty string.

    Examples
    --------
    >>> nearest("similarty", ["affine", "similarity"])
    " Did you mean 'similarity'?"
    """
    near = difflib.get_close_matches(word, list(known), n=1, cutoff=0.6)
    return f" Did you mean {near[0]!r}?" if near else ""


def shown(met: object) -> str:
    """A met value as a fault shows it: its repr, shortened.

    Examples
    --------
    >>> shown(20), len(shown("x" * 1000)) <= LONGEST
    ('20', True)
    """
    text = repr(met)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


def fault(path: Location, text: str, met: object = None) -> InitErrorDetails:
    """One finished fault, for `raised`; `text` is kept as it is."""
    # The text travels as context: a template would take its braces for blanks to fill in.
    told = PydanticCustomError("told", "{text}", {"text": text})
    return InitErrorDetails(type=told, loc=path, input=met)


def raised(faults: Iterable[InitErrorDetails]) -> ValidationError:
    """A pydantic error holding these faults; raised in a validator it joins those found elsewhere."""
    return ValidationError.from_exception_data("configuration", list(faults))


def told(error: ValidationError, model: type[BaseModel]) -> ValidationError:
    """The same error with every fault in our words."""
    return raised(fault(path, text, met) for path, text, met in _faults(error, model))


def lines(error: ValidationError, model: type[BaseModel]) -> list[str]:
    """One line a fault, in our words: ``stages.0.levels.0.shrink: must be at least 1. Got 0.``."""
    return [_line(path, text) for path, text, _ in _faults(error, model)]


def _line(path: Location, text: str) -> str:
    return f"{'.'.join(map(str, path))}: {text}" if path else text


def _faults(error: ValidationError, model: type[BaseModel]) -> Iterator[tuple[Location, str, object]]:
    found = error.errors(include_url=False)
    for each in found:
        if not _echoes(each, found):
            yield each["loc"], _text(each, model), each["input"]


def _echoes(each: ErrorDetails, found: list[ErrorDetails]) -> bool:
    """Whether a list is called too short only because pydantic did not count its faulty entries."""
    path = each["loc"]
    inner = (other["loc"] for other in found if other is not each)
    return each["type"] == "too_short" and any(other[: len(path)] == path for other in inner)


def _text(found: ErrorDetails, model: type[BaseModel]) -> str:
    kind, met, context = found["type"], found["input"], found.get("ctx", {})
    if kind == "told":
        return found["msg"]
    if kind in ("extra_forbidden", "missing"):
        owner = _owner(model, found["loc"][:-1])
        return (_unknown if kind == "extra_forbidden" else _missing)(str(found["loc"][-1]), owner)
    if kind == "literal_error":
        choices = str(context["expected"])
        known = [choice.strip("'") for choice in choices.replace(" or ", ", ").split(", ")]
        return f"must be {choices}. Got {shown(met)}.{nearest(str(met), known)}"
    if kind in _LIMITS:
        words, limit = _LIMITS[kind]
        bound = context[limit]
        plain = int(bound) if bound == int(bound) else bound
        return f"{words} {plain}. Got {shown(met)}."
    if kind in _WORDS:
        return f"{_WORDS[kind]}. Got {shown(met)}."
    return _other(found)


def _other(found: ErrorDetails) -> str:
    """A validator's own text, or pydantic's, with the value met if it does not tell it."""
    text = found["msg"].removeprefix("Value error, ").removeprefix("Assertion failed, ")
    text = text.replace("Input should be", "must be")
    text = text if text.endswith((".", "?")) else f"{text}."
    return text if "Got " in text else f"{text} Got {shown(found['input'])}."


def _unknown(key: str, owner: type[BaseModel] | None) -> str:
    known = list(owner.model_fields) if owner else []
    if not known:
        return "unknown option. There are none here: remove it."
    return f"unknown option.{nearest(key, known)} Known: {', '.join(known)}."


def _missing(key: str, owner: type[BaseModel] | None) -> str:
    field = owner.model_fields.get(key) if owner else None
    example = f" Write {key} = {json.dumps(field.examples[0])}." if field and field.examples else ""
    return f"is required and missing.{example}"


def _owner(model: type[BaseModel], path: Location) -> type[BaseModel] | None:
    """The model that a path inside another one leads to."""
    owner: type[BaseModel] | None = model
    for key in path:
        if isinstance(key, str):
            owner = _inner(owner.model_fields.get(key)) if owner else None
    return owner


def _inner(field: FieldInfo | None) -> type[BaseModel] | None:
    """The model that a field holds, or holds many of."""
    todo: list[Any] = [field.annotation] if field else []
    while todo:
        kind = todo.pop()
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            return kind
        todo.extend(get_args(kind))
    return None
