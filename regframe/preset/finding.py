"""Presets by name: those that regframe ships, and those of installed plugins."""

from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path

from regframe.errors import PresetError

GROUP = "regframe.preset"
"""Entry points of this group say ``preset-name = "package"``: the package holds preset-name.toml."""


def names() -> list[str]:
    """Names of all presets, sorted: the shipped ones and those of plugins.

    Examples
    --------
    >>> "paper-similarity" in names()
    True
    """
    return sorted({*shipped(), *(point.name for point in _plugins())})


def shipped() -> list[str]:
    """Names of the presets that regframe ships, sorted.

    Examples
    --------
    >>> "paper-similarity" in shipped()
    True
    """
    return sorted(path.stem for path in folder().glob("*.toml"))


def folder() -> Path:
    """Where the shipped presets are: inside an installed package, beside it in a checkout."""
    package = Path(__file__).parents[1]
    inside = package / "presets"
    return inside if inside.is_dir() else package.parent / "presets"


def origin(name: str) -> str:
    """Where a preset's name comes from: ``regframe``, or distributions.

    Examples
    --------
    >>> origin("paper-similarity")
    'regframe'
    """
    if (folder() / f"{name}.toml").is_file():
        return "regframe"
    return " and ".join(map(_source, _claims(name)))


def place(name: str) -> Path | None:
    """The file of a name, None where it is unknown; to find it, nothing is imported.

    Raises
    ------
    PresetError
        A plugin does not hold what it names, or two claim the name.

    Examples
    --------
    >>> place("paper-similarity") == folder() / "paper-similarity.toml"
    True
    """
    file = folder() / f"{name}.toml"
    if file.is_file():
        return file
    claims = _claims(name)
    if len(claims) > 1:
        message = f"the preset {name!r} is claimed by {origin(name)}. Remove one of them."
        raise PresetError(message)
    return _inside(claims[0]) if claims else None


def faults() -> dict[str, str]:
    """Presets of plugins that cannot be found, each with the reason."""
    found = {}
    for point in _plugins():
        label = f"{point.name} ({_source(point)}, {point.value})"
        if point.name in shipped():
            found[label] = (
                f"the name {point.name!r} is taken by regframe, whose preset is used. "
                "Rename the plugin's entry point and file."
            )
            continue
        try:
            place(point.name)
        except PresetError as error:
            found[label] = str(error)
    return found


def _inside(point: EntryPoint) -> Path:
    # Only a top-level package is found without running any of its code.
    spec = find_spec(point.value) if point.value.isidentifier() else None
    for location in (spec and spec.submodule_search_locations) or ():
        file = Path(location) / f"{point.name}.toml"
        if file.is_file():
            return file
    message = (
        f"the preset {point.name!r} of {_source(point)} is not there: its entry point {point.value!r} "
        f"must name a top-level package that holds {point.name}.toml. Reinstall or remove that plugin."
    )
    raise PresetError(message)


def _claims(name: str) -> list[EntryPoint]:
    return [point for point in _plugins() if point.name == name]


def _plugins() -> tuple[EntryPoint, ...]:
    return tuple(entry_points(group=GROUP))


def _source(point: EntryPoint) -> str:
    return point.dist.name if point.dist else point.value
