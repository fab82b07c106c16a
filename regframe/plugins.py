"""Components from a file of the user's, run only because the user named it."""

import os
import re
import sys
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from hashlib import sha256
from importlib.util import module_from_spec, spec_from_file_location
from inspect import isabstract
from pathlib import Path
from types import ModuleType

from regframe.catalog import KINDS
from regframe.component import Component
from regframe.errors import PresetError
from regframe.faults import nearest, shown
from regframe.registry import FILE_MODULE, AnyRegistry

CONFIG = "REGFRAME_CONFIG"


@dataclass(frozen=True)
class Loaded:
    """What came of a file.

    Parameters
    ----------
    path : Path
    found : tuple of (str, str)
        Kind and name of each component that can be used.
    faults : tuple of str
        What is wrong, a sentence each; the rest works.
    """

    path: Path
    found: tuple[tuple[str, str], ...] = ()
    faults: tuple[str, ...] = ()


@dataclass(frozen=True)
class Configuration:
    """The user's own file of settings.

    Parameters
    ----------
    path : Path
        Where it is, or would be.
    files : tuple of Path
        Plugins to load.
    faults : tuple of str
    """

    path: Path
    files: tuple[Path, ...] = ()
    faults: tuple[str, ...] = ()


def load(path: str | Path) -> Loaded:
    """Run a Python file and give a name to every component that it defines.

    A class that the file registers itself keeps the name it gives; any other is called by its class name
    in kebab-case, `MyMetric` is ``my-metric``. Faults are told, never raised: one broken file, or one class
    in it, takes nothing else down.

    Parameters
    ----------
    path : str or Path
        Running a file is trusting it, so only name your own.

    Examples
    --------
    >>> load("not-there.py").faults
    ("the plugin 'not-there.py' does not exist. Check the path.",)
    """
    file = Path(path).expanduser()
    if not file.is_file():
        what = "is a folder. Name a file in it" if file.is_dir() else "does not exist. Check the path"
        return Loaded(file, faults=(f"the plugin {str(file)!r} {what}.",))
    file = file.resolve()
    before = {registry.kind: set(registry.names()) for registry in KINDS.values()}
    try:
        module = _run(file)
    except (Exception, SystemExit) as error:
        # Anything may be raised by code that nobody has tried; it is told, and what it left is taken back.
        for registry, name in _added(before):
            registry.forget(name)
        told = str(error) if isinstance(error, PresetError) else f"{type(error).__name__}: {error}"
        return Loaded(file, faults=(f"the plugin {str(file)!r} cannot be imported: {told}",))
    faults = list(_name_classes(module, file))
    found = tuple((registry.kind, name) for registry, name in _held(module))
    return Loaded(file, found, tuple(faults))


def files() -> list[Path]:
    """Every plugin file that this process has run, so that another process can run them too."""
    modules = [module for name, module in sys.modules.items() if name.startswith(FILE_MODULE)]
    return [Path(module.__file__) for module in modules if module.__file__]


def configuration() -> Configuration:
    """What the user's configuration says.

    It is the file that ``REGFRAME_CONFIG`` names, else ``regframe/config.toml`` in the folder where the
    platform keeps settings; never a file of the working folder::

        [plugins]
        files = ["~/metrics/my_metric.py"]
    """
    path = _config_file()
    if not path.is_file():
        told = f"{CONFIG} names {str(path)!r}, which does not exist."
        return Configuration(path, faults=(told,) if os.environ.get(CONFIG) else ())
    try:
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        return Configuration(path, faults=(f"the configuration {str(path)!r} cannot be read: {error}.",))
    unknown = [key for key in tree if key != "plugins"]
    section = tree.get("plugins", {})
    unknown += [f"plugins.{key}" for key in section if key != "files"] if isinstance(section, dict) else []
    known = ("plugins", "plugins.files")
    faults = [
        f"the configuration {str(path)!r} has an unknown key {key!r}.{nearest(key, known)}" for key in unknown
    ]
    named = section.get("files", []) if isinstance(section, dict) else section
    if not isinstance(named, list) or not all(isinstance(each, str) for each in named):
        faults.append(
            f"in {str(path)!r}, plugins.files must be a list of paths in quotes. Got {shown(named)}."
        )
        named = []
    return Configuration(path, tuple(path.parent / Path(each).expanduser() for each in named), tuple(faults))


def _config_file() -> Path:
    named = os.environ.get(CONFIG)
    if named:
        return Path(named).expanduser()
    if sys.platform == "win32":
        folder = Path(os.environ.get("APPDATA") or "~/AppData/Roaming")
    elif sys.platform == "darwin":
        folder = Path("~/Library/Application Support")
    else:
        folder = Path(os.environ.get("XDG_CONFIG_HOME") or "~/.config")
    return folder.expanduser() / "regframe" / "config.toml"


def _run(file: Path) -> ModuleType:
    """The file as a module whose name is the same in every process."""
    mark = sha256(str(file).encode()).hexdigest()[:8]
    name = f"{FILE_MODULE}{re.sub(r'[^A-Za-z0-9]', '_', file.stem)}_{mark}"
    spec = spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        message = "it is no Python file. Its name ends in .py"
        raise PresetError(message)
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def _name_classes(module: ModuleType, file: Path) -> Iterator[str]:
    """Register what the file has not registered itself; yield faults."""
    classes = [
        cls for cls in vars(module).values() if isinstance(cls, type) and cls.__module__ == module.__name__
    ]
    components = [cls for cls in classes if issubclass(cls, Component)]
    if not components:
        bases = ", ".join(registry.base.__name__ for registry in KINDS.values())
        met = f" Got {', '.join(cls.__name__ for cls in classes)}." if classes else ""
        yield f"the plugin {str(file)!r} holds no component: a class that derives from {bases}.{met}"
    held = {registry[name] for registry, name in _held(module)}
    for cls in components:
        if cls in held:
            continue
        try:
            _register(cls)
        except PresetError as error:
            yield f"the plugin {str(file)!r}, class {cls.__name__}: {error}"


def _register(cls: type[Component]) -> None:
    registry = next((registry for registry in KINDS.values() if issubclass(cls, registry.base)), None)
    if registry is None:
        bases = ", ".join(registry.base.__name__ for registry in KINDS.values())
        message = f"it is of no kind. Derive it from one of {bases}."
        raise PresetError(message)
    if isabstract(cls):
        missing = ", ".join(sorted(cls.__abstractmethods__))
        message = f"it lacks {missing}. Write what every {registry.kind} must have."
        raise PresetError(message)
    words = re.findall(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])", cls.__name__)
    registry.register("-".join(words).lower())(cls)


def _held(module: ModuleType) -> Iterator[tuple[AnyRegistry, str]]:
    """Registered components that are defined in a module."""
    for registry in KINDS.values():
        for name in registry.added():
            if registry[name].__module__ == module.__name__:
                yield registry, name


def _added(before: dict[str, set[str]]) -> Iterable[tuple[AnyRegistry, str]]:
    return [
        (registry, name)
        for registry in KINDS.values()
        for name in registry.added()
        if name not in before[registry.kind]
    ]
