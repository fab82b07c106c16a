"""How far what stages hand on to each other agrees: measured by whole runs."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from regframe.engine.setting import Placement
from regframe.errors import RegframeError
from regframe.image import Image
from regframe.peer import whole
from regframe.preset import Preset, Stage

DESCENT = {
    "type": "gradient-descent",
    "estimate_learning_rate": "each-iteration",
    "maximum_step": 0.5,
    "keep": "last",
}
LEVELS: list[dict[str, Any]] = [{"shrink": 2, "smooth": 1.0, "iterations": 4}, {"iterations": 4}]
STAGE: dict[str, Any] = {
    "start": "identity",
    "transform": "affine",
    "interpolator": "linear",
    "metric": "mean-squares",
    "optimizer": DESCENT,
    "scales": "physical-shift",
    "gradient": "filtered",
    "levels": LEVELS,
}
POINTS = 300
SPLINE = {"type": "bspline", "mesh": [1]}
FIELD = {"type": "displacement-field", "update_variance": 1.75, "total_variance": 0.5}


@dataclass(frozen=True)
class Case:
    """One line: what is handed on, SimpleITK's setter, the stages that use it, and its relation to ITK."""

    name: str
    setter: str
    relation: str
    stages: tuple[dict[str, Any], ...]


CASES = (
    Case(
        "compose",
        "SetMovingInitialTransform",
        "The map found before is told as the moving-initial one.",
        ({"transform": "translation"}, {"start": "compose"}),
    ),
    Case(
        "field-smoothing",
        "SetSmoothingGaussianOnUpdate",
        "The same: `update_variance` and `total_variance` of `displacement-field`; smoothing by "
        "B-splines is not offered.",
        ({"transform": FIELD, "metric": "mattes"},),
    ),
    Case(
        "refine",
        "SetInitialTransformAsBSpline",
        "The same; ITK reads splines of order 2 as if they were of order 3 when it lays the lattice anew, "
        "and so does this.",
        ({"transform": SPLINE, "levels": [{**LEVELS[0], "refine": 1}, {**LEVELS[1], "refine": 2}]},),
    ),
)


def measured(pairs: tuple[tuple[Image, Image], ...]) -> Iterator[tuple[str, str, str, float, str, str]]:
    """Name, SimpleITK's setter, way, largest difference, unit and relation of each case.

    Parameters
    ----------
    pairs : tuple of pairs of images
        In a plane and in space.
    """
    for case in CASES:
        apart = max(_run(case, *pair) for pair in pairs)
        yield case.name, f"`{case.setter}`", "whole run, 2-D and 3-D", apart, "px", case.relation


def _run(case: Case, fixed: Image, moving: Image) -> float:
    """How far both engines' answers are apart at random points of the fixed image."""
    stages = tuple(Stage(**{**STAGE, **changes}) for changes in case.stages)
    runs = whole.run(Preset(stages=stages), fixed, moving, (), Placement())
    if runs.simpleitk is None:
        raise RegframeError(runs.refusal)
    inner = np.random.default_rng(5).random((POINTS, fixed.dim)) * (np.array(fixed.grid.shape) - 1.0)
    points = fixed.grid.points(inner)
    return float(np.abs(runs.native.warp(points) - runs.simpleitk.warp(points)).max())
