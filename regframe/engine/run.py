"""One call from two images to a result."""

from collections.abc import Iterable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from regframe.engine.base import Engine, Observer, Result
from regframe.engine.setting import Placement
from regframe.errors import PresetError
from regframe.faults import nearest
from regframe.io import coerce
from regframe.preset import Preset, load, parse
from regframe.transforms.warp import Chain, Warp

ENGINES: Mapping[str, str] = {
    "native": "regframe.engine.native:Native",
    "simpleitk": "regframe.peer.simpleitk:SimpleITKEngine",
}
"""Name to ``module:Class``, imported when first asked for."""


def register(
    preset: Preset | str | Path | Mapping[str, Any],
    fixed: Any,
    moving: Any,
    *,
    engine: str | Engine = "native",
    observers: Iterable[Observer] = (),
    start: Warp | Chain | Placement | None = None,
) -> Result:
    """Align a moving image to a fixed one.

    Parameters
    ----------
    preset : Preset, name, path or mapping
        The whole experiment; ``regframe list presets`` names what is shipped.
    fixed, moving : path, numpy array, SimpleITK image or Image
        Masks travel on an `Image`: ``image.with_mask(array != 0)``.
    engine : str or Engine
    observers : callables
        Each is called with a Progress after every iteration.
    start : Warp, Chain or Placement, optional
        Where the first stage begins, in place of its own `start`; or a Placement, which also holds maps that
        stay before and after the searched one, and the grid of samples.

    Returns
    -------
    Result

    Raises
    ------
    PresetError
        A fault in the preset, before any image is read.
    ImageError, GeometryError
        Images that cannot be read, or do not fit.
    NoOverlapError
        Nothing of the images meets under the start, or on the way.

    Examples
    --------
    >>> from regframe.testing.phantoms import visual_thermal
    >>> pair = visual_thermal(seed=1, shape=(96, 128))
    >>> result = register({"extends": "paper-similarity", "stages.0.levels.0.iterations": 5},
    ...                   pair.fixed, pair.moving)
    >>> result.pixel_matrix.shape
    (3, 3)
    """
    resolved = as_preset(preset)
    chosen = _engine(engine)
    steps = chosen.iterate(resolved, coerce(fixed, "fixed"), coerce(moving, "moving"), start=start)
    watching = tuple(observers)
    while True:
        try:
            progress = next(steps)
        except StopIteration as end:
            result: Result = end.value
            return result
        for observer in watching:
            observer(progress)


def as_preset(preset: Preset | str | Path | Mapping[str, Any]) -> Preset:
    """A preset as it is, or one loaded from its name, path or mapping."""
    if isinstance(preset, Preset):
        return preset
    return parse(preset) if isinstance(preset, Mapping) else load(preset)


def _engine(engine: str | Engine) -> Engine:
    if isinstance(engine, Engine):
        return engine
    if engine not in ENGINES:
        message = f"no engine is called {engine!r}.{nearest(engine, ENGINES)} Known: {', '.join(ENGINES)}."
        raise PresetError(message)
    module, _, name = ENGINES[engine].partition(":")
    made: Engine = getattr(import_module(module), name)()
    return made
