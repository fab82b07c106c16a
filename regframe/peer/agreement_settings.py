"""How far what a preset or a call says beside its components agrees: measured by whole runs and starts."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from regframe.engine.setting import Placement
from regframe.engine.start import begin
from regframe.errors import RegframeError
from regframe.geometry import Frame, Grid
from regframe.image import Image
from regframe.peer import convert, whole
from regframe.preset import Preset, Stage
from regframe.transforms.affine import Affine
from regframe.transforms.warp import Warp

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
    """One line: a setting, SimpleITK's setter, the stages that use it, and how it relates to ITK's."""

    name: str
    setter: str
    relation: str
    stages: tuple[dict[str, Any], ...] = ({},)
    place: Callable[[Grid], Placement] = field(default=lambda _: Placement())


def _known(grid: Grid) -> Warp:
    """An affine map about a centre that is not the grid's."""
    dim = grid.dim
    matrix = np.eye(dim) + 0.02 * np.arange(dim * dim).reshape(dim, dim) / dim
    params = np.concatenate([matrix.ravel(), np.linspace(-0.6, 0.8, dim)])
    return Warp(Affine(), params, Frame(grid, grid.centre + 1.5))


def _inner(grid: Grid) -> Grid:
    """A lattice over the grid's middle, between its points."""
    shape = tuple(n - 5 for n in grid.shape)
    return Grid(
        shape,
        grid.spacing,
        tuple(o + 2.3 * s for o, s in zip(grid.origin, grid.spacing, strict=True)),
        grid.direction,
    )


CASES = (
    Case(
        "compose",
        "SetMovingInitialTransform",
        "The map found before is told as the moving-initial one.",
        ({"transform": "translation"}, {"start": "compose"}),
    ),
    Case("domain", "SetVirtualDomain", "The same.", place=lambda grid: Placement(domain=_inner(grid))),
    Case(
        "field-smoothing",
        "SetSmoothingGaussianOnUpdate",
        "The same: `update_variance` and `total_variance` of `displacement-field`; smoothing by "
        "B-splines is not offered.",
        ({"transform": FIELD, "metric": "mattes"},),
    ),
    Case(
        "fixed-initial",
        "SetFixedInitialTransform",
        "The same; it must be affine, so that the result can lead from the fixed image to the moving one.",
        place=lambda grid: Placement(fixed_initial=_known(grid)),
    ),
    Case(
        "frozen",
        "SetOptimizerWeights",
        "A weight of 0 where ITK heeds weights; other searches are shown the free parameters alone, and "
        "SimpleITK is told a scale that lets the frozen ones not move.",
        ({"frozen": ["tx"]},),
    ),
    Case(
        "moving-initial",
        "SetMovingInitialTransform",
        "The same, but for the centre: ITK sets the searched map's centre to that of the map after it, and "
        "regframe tells SimpleITK a map about the same centre.",
        place=lambda grid: Placement(moving_initial=_known(grid)),
    ),
    Case(
        "refine",
        "SetInitialTransformAsBSpline",
        "The same; ITK reads splines of order 2 as if they were of order 3 when it lays the lattice anew, "
        "and so does this.",
        ({"transform": SPLINE, "levels": [{**LEVELS[0], "refine": 1}, {**LEVELS[1], "refine": 2}]},),
    ),
    Case(
        "smooth-unit",
        "SetSmoothingSigmasAreSpecifiedInPhysicalUnits",
        "The same.",
        ({"smooth_unit": "voxels"},),
    ),
    Case(
        "weights",
        "SetOptimizerWeights",
        "The same, one number an axis for displacement fields; ITK's searches without slopes ignore weights "
        "in silence, and regframe refuses them there.",
        ({"weights": True},),
    ),
)
STARTS = {
    "centres": "The same.",
    "moments": "The same.",
    "principal-axes": (
        "The same centres. ITK multiplies its matrices of axes in the wrong order and turns the wrong way; "
        "here the smallest turn that lays the axes on each other is taken. For ITK's start, write what its "
        "initialiser gives to a file and pass it as `start`."
    ),
}


def measured(pairs: tuple[tuple[Image, Image], ...]) -> Iterator[tuple[str, str, str, float, str, str]]:
    """Name, SimpleITK's setter, way, largest difference, unit and relation of each setting.

    Parameters
    ----------
    pairs : tuple of pairs of images
        In a plane and in space.
    """
    for case in CASES:
        apart = max(_run(case, *pair) for pair in pairs)
        yield case.name, f"`{case.setter}`", "whole run, 2-D and 3-D", apart, "px", case.relation
    for start, relation in STARTS.items():
        setter = (
            "CenteredVersorTransformInitializer"
            if start == "principal-axes"
            else "CenteredTransformInitializer"
        )
        apart = _start(start, *pairs[-1])
        yield start, f"`{setter}`", "centre and translation, 3-D", apart, "px", relation


def _run(case: Case, fixed: Image, moving: Image) -> float:
    """How far both engines' answers are apart at random points of the fixed image."""
    count = fixed.dim * (fixed.dim + 1)
    stages = [{**STAGE, **changes} for changes in case.stages]
    for stage in stages:
        if stage.get("weights"):
            stage["weights"] = [1.0] * (count - 1) + [0.25]
    runs = whole.run(
        Preset(stages=tuple(Stage(**stage) for stage in stages)), fixed, moving, (), case.place(fixed.grid)
    )
    if runs.simpleitk is None:
        raise RegframeError(runs.refusal)
    inner = np.random.default_rng(5).random((POINTS, fixed.dim)) * (np.array(fixed.grid.shape) - 1.0)
    points = fixed.grid.points(inner)
    return float(np.abs(runs.native.warp(points) - runs.simpleitk.warp(points)).max())


def _start(start: str, fixed: Image, moving: Image) -> float:
    """How far the centre and the translation of a start are from those of SimpleITK's initialiser."""
    import SimpleITK as sitk

    stage = Stage(**{**STAGE, "start": start, "transform": "versor-rigid"})
    ours = begin(stage, fixed, moving, None)
    images, blank = tuple(map(convert.image, (fixed, moving))), sitk.VersorRigid3DTransform()
    if start == "principal-axes":
        made = sitk.CenteredVersorTransformInitializer(images[0], images[1], blank, True)
    else:
        kind = sitk.CenteredTransformInitializerFilter.MOMENTS
        if start == "centres":
            kind = sitk.CenteredTransformInitializerFilter.GEOMETRY
        made = sitk.CenteredTransformInitializer(images[0], images[1], blank, kind)
    theirs = sitk.VersorRigid3DTransform(made)
    centre, shift = np.array(theirs.GetCenter()), np.array(theirs.GetTranslation())
    return float(max(np.abs(ours.frame.centre - centre).max(), np.abs(ours.params[3:] - shift).max()))
