"""Names to component classes, imported when first asked for."""

import json
import re
import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Generic, TypeVar

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationError
from pydantic_core import CoreSchema, core_schema

from regframe.component import Component
from regframe.errors import PresetError
from regframe.faults import fault, lines, nearest, raised, told

C = TypeVar("C", bound=Component)

FILE_MODULE = "regframe_file_"
"""How the names of modules begin that were made from a file which the user named; see `regframe.plugins`."""

REFERENCE = "x-regframe-kind"
"""Key that stands for a reference to "any component of this kind" in unfinished schemas."""


class Registry(Generic[C]):
    """The table of one kind of component.

    Built-in classes are listed as ``module:Class`` and plugins as entry points of the group
    ``regframe.<kind>``; neither is imported before it is used. A pydantic field says
    ``Annotated[Metric, METRICS]`` to take whatever `build` takes.

    Parameters
    ----------
    kind : str
        What messages call a member, and the entry-point group's last word.
    base : str
        ``module:Class`` that every member derives from.
    builtin : mapping of str to str
        Name to ``module:Class``.
    """

    def __init__(self, kind: str, base: str, builtin: Mapping[str, str]) -> None:
        self.kind = kind
        self._base = base
        self._builtin = dict(builtin)
        self._added: dict[str, type[C]] = {}
        self._loaded: dict[str, type[C]] = {}
        self._scanned: tuple[tuple[str, ...], tuple[EntryPoint, ...]] = ((), ())

    def register(self, name: str) -> Callable[[type[C]], type[C]]:
        """Decorate a class to give it a name in this process (scripts, notebooks, tests).

        Raises
        ------
        PresetError
            The name is taken by another class, or the class is of another kind.
        """

        def add(cls: type[C]) -> type[C]:
            self._check(name, cls)
            # Running a notebook cell again replaces the class that it defined before.
            if name in self.names() and not _same(cls, self._added.get(name)):
                message = (
                    f"{name!r} is already the name of {self._a} ({self.origin(name)}). Choose another name."
                )
                raise PresetError(message)
            self._added[name] = cls
            return cls

        return add

    def forget(self, name: str) -> None:
        """Take back a name given by `register`."""
        self._added.pop(name, None)

    def added(self) -> list[str]:
        """Names given by `register` in this process, sorted."""
        return sorted(self._added)

    @property
    def base(self) -> type[C]:
        """The class that every member derives from."""
        module, _, attribute = self._base.partition(":")
        found: type[C] = getattr(import_module(module), attribute)
        return found

    def names(self) -> list[str]:
        """Every known name, sorted; imports nothing."""
        return sorted({*self._builtin, *self._added, *(point.name for point in self._plugins())})

    def origin(self, name: str) -> str:
        """Where a name comes from: ``regframe``, distributions, a file, or ``this session``.

        Raises
        ------
        PresetError
            Unknown name.
        """
        if name in self._builtin:
            return "regframe"
        if name in self._added:
            return _home(self._added[name])
        claims = self._claims(name)
        if not claims:
            raise PresetError(self._unknown(name))
        return " and ".join(_source(point) for point in claims)

    def faults(self) -> dict[str, str]:
        """Plugins that cannot be used, each with the reason; imports every plugin."""
        found = {}
        for point in self._plugins():
            label = f"{point.name} ({_source(point)}, {point.value})"
            if point.name in self._builtin:
                found[label] = (
                    f"the name {point.name!r} is taken by {self.origin(point.name)}, which is used. "
                    "Rename the plugin's entry point."
                )
                continue
            try:
                self[point.name]
            except PresetError as error:
                found[label] = str(error)
        return found

    def __getitem__(self, name: str) -> type[C]:
        """The class of a name; imports its module.

        Raises
        ------
        PresetError
            Unknown name, or a plugin that cannot be imported.
        """
        if name in self._added:
            return self._added[name]
        if name not in self._loaded:
            self._loaded[name] = self._load(name)
        return self._loaded[name]

    def name_of(self, component: C | type[C]) -> str:
        """The name a component or class is registered under.

        Raises
        ------
        PresetError
            It has none.
        """
        cls = component if isinstance(component, type) else type(component)
        for table in (self._added, self._loaded):
            for name, known in table.items():
                if known is cls:
                    return name
        target = f"{cls.__module__}:{cls.__qualname__}"
        for name, place in self._builtin.items():
            if place == target:
                return name
        for point in self._plugins():
            if point.value == target:
                return point.name
        message = (
            f"{cls.__qualname__} is not a registered {self.kind}. "
            f'Put @{self.kind.upper()}S.register("a-name") above the class.'
        )
        raise PresetError(message)

    def build(self, config: object) -> C:
        """A component from its name, from a table with ``type`` and options, or an instance unchanged.

        Raises
        ------
        PresetError
            Unknown name, unknown or wrong option, or something that is not a configuration.
        """
        found = self._named(config)
        if isinstance(found, Component):
            return found
        cls, options = found
        try:
            return _made(cls, options)
        except ValidationError as error:
            message = f"{self.kind} {self.name_of(cls)!r}: {'; '.join(lines(error, cls))}"
            raise PresetError(message) from None

    def validate(self, config: object) -> C:
        """As `build`, inside a pydantic model: each fault keeps its own path.

        Raises
        ------
        ValidationError
            As `build`; pydantic puts the path of the field in front.
        """
        try:
            found = self._named(config)
        except PresetError as error:
            raise raised([fault((), str(error), config)]) from None
        if isinstance(found, Component):
            return found
        cls, options = found
        try:
            return _made(cls, options)
        except ValidationError as error:
            raise told(error, cls) from None

    def dump(self, component: C) -> dict[str, Any]:
        """The table that `build` would make the component from."""
        return {"type": self.name_of(component), **component.model_dump(mode="json")}

    def schemas(self) -> dict[str, Any]:
        """JSON schemas by reference name: one a usable component, and one of "any of this kind"."""
        found: dict[str, Any] = {}
        broken = []
        for name in self.names():
            prefix = f"{self.kind}.{name}"
            try:
                tree = self[name].model_json_schema(ref_template=f"#/$defs/{prefix}.{{model}}")
            except PresetError:
                broken.append(name)
                continue
            inner = tree.pop("$defs", {})
            tree["properties"] = {"type": {"const": name}, **tree.get("properties", {})}
            tree["required"] = ["type", *tree.get("required", [])]
            found |= {f"{prefix}.{key}": value for key, value in inner.items()} | {prefix: tree}
        usable = [name for name in self.names() if name not in broken]
        tables = [{"$ref": f"#/$defs/{self.kind}.{name}"} for name in usable]
        return {**found, self.kind: {"anyOf": [{"enum": usable}, *tables]}}

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(
            self.validate, serialization=core_schema.plain_serializer_function_ser_schema(self.dump)
        )

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        # A `$ref` would be looked up by pydantic at once; `preset.schema` makes it one.
        return {REFERENCE: self.kind}

    @property
    def _a(self) -> str:
        return f"{'an' if self.kind[0] in 'aeiou' else 'a'} {self.kind}"

    def _named(self, config: object) -> C | tuple[type[C], dict[str, Any]]:
        """An instance as it is, or the class and options that a configuration names."""
        if isinstance(config, Component):
            self._check(type(config).__name__, type(config))
            return config  # type: ignore[return-value]  # checked against the base on the line above
        if isinstance(config, str):
            return self[config], {}
        if isinstance(config, Mapping) and isinstance(config.get("type"), str):
            return self[config["type"]], {key: value for key, value in config.items() if key != "type"}
        example = self.names()[0]
        message = (
            f"{self._a} is a name or a table with `type`. Got {config!r}. "
            f'Write "{example}" or {{type = "{example}"}}.'
        )
        raise PresetError(message)

    def _load(self, name: str) -> type[C]:
        place = self._place(name)
        module, _, attribute = place.partition(":")
        try:
            cls = getattr(import_module(module), attribute)
        except Exception as error:
            # A plugin may fail in any way at import; it must be named and must not take others down.
            message = (
                f"the {self.kind} {name!r} of {self.origin(name)} cannot be imported from {place}: "
                f"{type(error).__name__}: {error}. Reinstall or remove that plugin."
            )
            raise PresetError(message) from error
        self._check(name, cls)
        found: type[C] = cls
        return found

    def _place(self, name: str) -> str:
        if name in self._builtin:
            return self._builtin[name]
        claims = self._claims(name)
        if not claims:
            raise PresetError(self._unknown(name))
        if len(claims) > 1:
            message = f"the {self.kind} {name!r} is claimed by {self.origin(name)}. Remove one of them."
            raise PresetError(message)
        return claims[0].value

    def _unknown(self, name: str) -> str:
        known = self.names()
        if re.search(r"\.py\b|[/\\:]", name):
            return (
                f"{name!r} names code, and a preset cannot run any: it may come from a stranger. "
                f"Write the name of {self._a}; if its file is yours, load it with --plugin FILE, or in your "
                "configuration."
            )
        return f"no {self.kind} is called {name!r}.{nearest(name, known)} Known: {', '.join(known)}."

    def _check(self, name: str, cls: Any) -> None:
        if not (isinstance(cls, type) and issubclass(cls, Component) and issubclass(cls, self.base)):
            base = self.base.__name__
            message = (
                f"{name!r} cannot be {self._a}: {cls!r} does not derive from {base}. "
                f"Write class {getattr(cls, '__name__', 'Mine')}({base})."
            )
            raise PresetError(message)
        if "type" in cls.model_fields:
            message = f"{name!r} cannot have an option `type`: presets put the name there. Rename it."
            raise PresetError(message)

    def _claims(self, name: str) -> list[EntryPoint]:
        return [point for point in self._plugins() if point.name == name]

    def _plugins(self) -> tuple[EntryPoint, ...]:
        """Entry points of this kind, read again only when the import path has changed."""
        where = tuple(sys.path)
        if self._scanned[0] != where:
            self._scanned = (where, tuple(entry_points(group=f"regframe.{self.kind}")))
        return self._scanned[1]


def _made(cls: type[C], options: dict[str, Any]) -> C:
    """A component from options; what a file can hold is read strictly, "32" is no number."""
    try:
        text = json.dumps(options)
    except TypeError:
        # Only a program can put Python objects here, and it means the types that it gives.
        return cls.model_validate(options)
    # JSON, because strict Python input would refuse TOML's lists for tuples.
    return cls.model_validate_json(text, strict=True)


def _same(cls: type[C], other: type[C] | None) -> bool:
    """Whether two classes are one definition, run twice."""
    return other is not None and (cls.__module__, cls.__qualname__) == (other.__module__, other.__qualname__)


def _home(cls: type[Component]) -> str:
    """The file of a class from a file that the user named; any other belongs to the session."""
    file = getattr(sys.modules.get(cls.__module__), "__file__", None)
    return str(file) if file and cls.__module__.startswith(FILE_MODULE) else "this session"


def _source(point: EntryPoint) -> str:
    return point.dist.name if point.dist else point.value


AnyRegistry = Registry[Any]
