"""``regframe doctor``: what regframe runs on, and what is missing."""

import os
from pathlib import Path

import typer

from regframe.cli import plugin_files
from regframe.cli.plugin_files import Plugins

PACKAGES = ("numpy", "numba", "scipy", "SimpleITK", "pydantic", "matplotlib", "rich", "typer")
EXTRAS = (("opencv", "cv2", "features"),)
"""What it is, the module to look for, and the extra that brings it."""


def doctor(plugin: Plugins = None) -> None:
    """Tell versions, threads, the kernel cache, extras and plugins; a report of a fault needs them."""
    for title, facts in (
        ("versions", _versions()),
        ("threads", _threads()),
        ("kernel cache", _cache()),
        ("extras", _extras()),
        ("plugins", _plugins(plugin)),
    ):
        typer.secho(title, bold=True)
        width = max(len(name) for name, _ in facts)
        for name, text in facts:
            typer.echo(f"  {name:{width}}  {text}")


def _versions() -> list[tuple[str, str]]:
    import platform
    from importlib.metadata import PackageNotFoundError, version

    from regframe import __version__

    place = Path(__file__).parents[1]
    facts = [("python", f"{platform.python_version()} on {platform.system()} {platform.machine()}")]
    facts.append(("regframe", f"{__version__} in {place}"))
    for package in PACKAGES:
        try:
            facts.append((package, version(package)))
        except PackageNotFoundError:
            facts.append((package, f"MISSING. pip install {package}"))
    return facts


def _threads() -> list[tuple[str, str]]:
    from regframe.kernels.sharing import threads

    wish = os.environ.get("REGFRAME_THREADS")
    source = f"REGFRAME_THREADS={wish}" if wish else "as many as this process may use"
    return [("kernels", f"{threads()} ({source})"), ("processors", str(os.cpu_count()))]


def _cache() -> list[tuple[str, str]]:
    from regframe.kernels import linear

    folder = Path(linear.resample.stats.cache_path)  # type: ignore[attr-defined]  # numba adds it
    stored = list(folder.glob("*.nbc")) if folder.is_dir() else []
    size = sum(one.stat().st_size for one in stored) / 2**20
    state = (
        f"{len(stored)} compiled kernels, {size:.1f} MB" if stored else "empty; fill it with regframe warmup"
    )
    place = folder if folder.exists() else folder.parent
    writable = "yes" if os.access(place, os.W_OK) else "NO: every run compiles anew. Set NUMBA_CACHE_DIR."
    return [("folder", str(folder)), ("holds", state), ("writable", writable)]


def _extras() -> list[tuple[str, str]]:
    from importlib.util import find_spec

    return [
        (name, "found" if find_spec(module) else f'not installed. pip install "regframe[{extra}]"')
        for name, module, extra in EXTRAS
    ]


def _plugins(named: list[Path] | None) -> list[tuple[str, str]]:
    from regframe import preset
    from regframe.catalog import KINDS

    settings, loaded = plugin_files.load(named)
    state = (
        f"{len(settings.files)} plugin files"
        if settings.path.is_file()
        else "not there; it may list plugin files"
    )
    facts = [("configuration", f"{settings.path}: {state}")]
    facts += [("configuration", f"FAULT: {text}") for text in settings.faults]
    facts += [(each.path.name, f"FAULT: {text}") for each in loaded for text in each.faults]
    for registry in KINDS.values():
        faults = registry.faults()
        facts += [(name, f"FAULT: {text}") for name, text in faults.items()]
        facts += [
            (name, f"{registry.kind} of {registry.origin(name)}")
            for name in registry.names()
            if registry.origin(name) != "regframe" and name not in faults
        ]
    unfound = preset.faults()
    facts += [(name, f"FAULT: {text}") for name, text in unfound.items()]
    facts += [
        (name, f"preset of {preset.origin(name)}")
        for name in preset.names()
        if preset.origin(name) != "regframe" and name not in unfound
    ]
    if len(facts) == 1:
        facts.append(("none", "components of other packages and of your own files would be listed here"))
    return facts
