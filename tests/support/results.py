"""Results made by hand: quick, and known to the last number."""

import numpy as np

from regframe.engine.base import LevelReport, Progress, Result
from regframe.geometry import Frame, Grid
from regframe.image import Image
from regframe.preset import load
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Warp

STEPS = 5


def image(array, name, *, spacing=None):
    """An image of an array, on a camera grid or one with a spacing."""
    plain = Image.of_array(array, name=name)
    if spacing is None:
        return plain
    shape = plain.grid.shape
    direction = Grid.of_shape(shape).direction
    return Image(plain.values, Grid(shape, spacing, (0.0,) * len(shape), direction), raw=plain.raw, name=name)


def ramp(shape, dtype=np.uint8):
    """Distinct values that rise along every axis."""
    indices = np.indices(shape, dtype=np.float64)
    weights = 10.0 ** np.arange(len(shape))
    return np.asarray(np.tensordot(weights, indices, 1) % 251, dtype)


def result(fixed=None, moving=None, *, shift=None, levels=2):
    """A translation in two levels of five steps, or a similarity when no shift is given."""
    fixed = fixed or image(ramp((12, 16)), "visual.png")
    moving = moving or image(ramp((12, 16)), "thermal.png")
    frame = Frame.about_centre(fixed.grid)
    if shift is None:
        preset, start = "paper-similarity", Warp(Similarity(), np.array([1.0, 0.0, 0.0, 0.0]), frame)
        warp = Warp(Similarity(), np.array([1.1, 0.05, 2.0, -1.0]), frame)
    else:
        preset, start = "paper-affine", Warp(Translation(), np.zeros(len(shift)), frame)
        warp = Warp(Translation(), np.array(shift, dtype=np.float64), frame)
    changes = {"stages.0.levels.1": {"iterations": STEPS}} if levels > 1 else {}
    if shift is not None:
        changes |= {"stages.0.transform": "translation"}
    return Result(
        warp,
        -0.5,
        "the limit of 5 iterations",
        tuple(_level(fixed, warp, level) for level in range(levels)),
        load(preset, changes),
        {"seed": 1, "finished": "2020-01-01T00:00:00+00:00", "seconds": 1.5},
        fixed,
        moving,
        tuple(_step(warp, level, i) for level in range(levels) for i in range(STEPS)),
        start,
    )


def _level(fixed, warp, level):
    params = tuple(map(float, warp.params))
    value = -0.4 - 0.1 * level
    shape = fixed.grid.shape
    return LevelReport(
        0,
        level,
        shape,
        fixed.grid.size,
        STEPS,
        STEPS + 1,
        -0.3,
        value,
        "the limit of 5 iterations",
        0.25,
        params,
        warp.frame,
    )


def _step(warp, level, i):
    return Progress(0, level, i, STEPS, -0.3 - 0.01 * i, warp.params, 2.0 / (i + 1), 0.1 * i, i + 2)
