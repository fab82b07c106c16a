"""What SimpleITK's method offers beside components, set on one small run each and measured."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from regframe.engine.setting import Placement
from regframe.engine.start import begin
from regframe.errors import RegframeError
from regframe.geometry import Frame, Grid
from regframe.image import Image
from regframe.peer import convert, whole
from regframe.peer.agreement import Row, waves
from regframe.peer.report import largest
from regframe.preset import Preset, Stage
from regframe.transforms.affine import Affine
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Chain, Warp
from regframe.types import Points

if TYPE_CHECKING:
    import SimpleITK as sitk

Pair = tuple[Image, Image]
DESCENT = {
    "type": "regular-step-gradient-descent",
    "learning_rate": 0.3,
    "minimum_step": 1e-5,
    "gradient_tolerance": 0.0,
    "keep": "last",
}
ESTIMATED = {**DESCENT, "estimate_learning_rate": "once", "maximum_step": 1.0}
PLAIN = {"type": "gradient-descent", "keep": "last", "maximum_step": 1.0}
SLOPES = {"optimizer": DESCENT, "gradient": "filtered", "scales": [400.0, 400.0, 1.0, 1.0]}
DRAWN = {"shrink": 1, "smooth": 0.0, "iterations": 30, "fraction": 0.4}
RESET = {**PLAIN, "estimate_learning_rate": "each-iteration", "maximum_step": 0.5}
LEVELS: list[dict[str, Any]] = [{"shrink": 2, "smooth": 1.0, "iterations": 4}, {"iterations": 4}]
STEPPED = {
    "start": "identity",
    "transform": "affine",
    "optimizer": RESET,
    "scales": "physical-shift",
    "gradient": "filtered",
    "levels": LEVELS,
}
FIELD = {"type": "displacement-field", "update_variance": 1.75, "total_variance": 0.5}
MESH = {"type": "bspline", "mesh": [1]}
INNER = 300
"""Points within the image at which maps are compared, beside its corners."""
SHAPES: tuple[tuple[int, ...], ...] = ((40, 48), (14, 16, 18))
ITK_AXES = "itk-principal-axes"
TURNED = 0.4
"""Radians by which the oblique grids are turned."""


@dataclass(frozen=True)
class Case:
    """One setting: what it is called on both sides, and the run that shows it, of a stage or of several."""

    name: str
    twin: str
    relation: str
    changes: Mapping[str, Any] = field(default_factory=dict)
    stages: tuple[Mapping[str, Any], ...] = ({},)
    prepared: Callable[[Pair], Pair] = lambda pair: pair
    placed: Callable[[Pair], Placement | None] = lambda _: None


def rows() -> list[Row]:
    """Every setting, measured now."""
    return [*(_row(case) for case in CASES), *_starts()]


def _row(case: Case) -> Row:
    apart = [_apart(case, shape) for shape in SHAPES]
    return Row(case.name, case.twin, "whole run, 2-D and 3-D", largest(apart), "px", case.relation)


def _apart(case: Case, shape: tuple[int, ...]) -> float:
    pair = case.prepared(waves(shape))
    stages = tuple(_stage({**case.changes, **changes}, len(shape)) for changes in case.stages)
    runs = whole.run(Preset(stages=stages), *pair, place=case.placed(pair))
    if runs.simpleitk is None or not runs.alike:
        message = f"the setting {case.name!r} no longer compares: {runs.refusal or 'other walks'}"
        raise RegframeError(message)
    grid = pair[0].grid
    inner = np.random.default_rng(5).random((INNER, grid.dim)) * (np.array(grid.shape) - 1.0)
    points = np.concatenate([grid.corners(), grid.points(inner)])  # a map that bends may keep the corners
    return float(np.abs(runs.native.warp(points) - runs.simpleitk.warp(points)).max())


def _stage(changes: Mapping[str, Any], dim: int) -> Stage:
    parts: dict[str, Any] = {
        "transform": "similarity" if dim == 2 else "rigid",
        "interpolator": "linear",
        "metric": "mean-squares",
        "optimizer": "one-plus-one",
        "levels": [{"shrink": 2, "smooth": 1.0, "iterations": 6}],
    }
    parts |= changes
    if dim == 3:
        # Lists are written for a plane's four parameters: two that turn, then the shift.
        for name in ("scales", "weights"):
            if isinstance(parts.get(name), list):
                parts[name] = [parts[name][0]] * 3 + [parts[name][-1]] * 3
    return Stage(**parts)


def _masked(pair: Pair) -> Pair:
    along, across = (np.indices(pair[0].grid.shape)[axis] for axis in (0, -1))
    return pair[0].with_mask(along + across > 6), pair[1].with_mask(across < 14)


def _single(pair: Pair) -> Pair:
    return tuple(Image(one.values.round().astype(np.float32), one.grid, name=one.name) for one in pair)  # type: ignore[return-value]  # two of them


def _oblique(pair: Pair) -> Pair:
    dim = pair[0].dim
    turn = np.eye(dim)
    turn[:2, :2] = [[np.cos(TURNED), -np.sin(TURNED)], [np.sin(TURNED), np.cos(TURNED)]]
    spacing = (0.9, 1.2, 1.1)[:dim]
    grid = Grid(pair[0].grid.shape, spacing, (3.0, -2.0, 5.0)[:dim], tuple(map(tuple, turn.tolist())))
    return tuple(Image(one.values, grid, name=one.name) for one in pair)  # type: ignore[return-value]  # two of them


def _shift(pair: Pair, size: float) -> Warp:
    frame = Frame.about_centre(pair[0].grid)
    return Warp(Translation(), np.full(pair[0].dim, size), frame)


def _beyond(pair: Pair) -> Placement:
    frame = Frame.about_centre(pair[0].grid)
    affine = Warp(Affine(), Affine().identity(frame) + 0.01, frame)
    return Placement(moving_initial=Chain((affine, _shift(pair, 0.4))))


def _below(pair: Pair) -> Placement:
    return Placement(fixed_initial=_shift(pair, 0.7))


def _domain(pair: Pair) -> Placement:
    shape = tuple(n - 4 for n in pair[0].grid.shape)
    first = pair[0].grid.points(np.full((1, pair[0].dim), 1.5))[0]
    return Placement(
        domain=Grid(shape, pair[0].grid.spacing, tuple(map(float, first)), pair[0].grid.direction)
    )


CASES = (
    Case(
        "masks",
        "`SetMetricFixedMask`, `SetMetricMovingMask`",
        "The same: a point counts where the nearest pixel of the mask does.",
        prepared=_masked,
    ),
    Case(
        'sampling = "regular"',
        "`SetMetricSamplingStrategy`, `SetMetricSamplingPercentagePerLevel`",
        "The same places, with ITK's jitter drawn from the preset's seed.",
        {"levels": [{**DRAWN, "sampling": "regular"}]},
    ),
    Case(
        'sampling = "random"',
        "`SetMetricSamplingStrategy`, `SetMetricSamplingPercentagePerLevel`",
        "The same draws from the preset's seed; SimpleITK's default is the clock.",
        {"levels": [{**DRAWN, "sampling": "random"}]},
    ),
    Case(
        "shrink, smooth",
        "`SetShrinkFactorsPerLevel`, `SetSmoothingSigmasPerLevel`",
        "The same grids and smoothed images, in physical units by default.",
        {"levels": [{"shrink": n, "smooth": n - 1.0, "iterations": 20} for n in (3, 2, 1)]},
    ),
    Case(
        'smooth_unit = "voxels"',
        "`SetSmoothingSigmasAreSpecifiedInPhysicalUnits`",
        "The same; ask for it, as physical units are the default of both.",
        {"smooth_unit": "voxels"},
        prepared=_oblique,
    ),
    Case(
        "scales as a list",
        "`SetOptimizerScales`",
        "The same; a wrong number of them is an error, where SimpleITK takes ones in silence.",
        SLOPES,
    ),
    *(
        Case(
            f'scales = "{kind}"',
            f"`SetOptimizerScalesFrom{setter}`",
            'The same; `scales = "shift"`, pixels of motion, is the default here.',
            {**SLOPES, "scales": kind, "optimizer": ESTIMATED},
        )
        for kind, setter in (
            ("physical-shift", "PhysicalShift"),
            ("index-shift", "IndexShift"),
            ("jacobian", "Jacobian"),
        )
    ),
    *(
        Case(
            f'estimate_learning_rate = "{when}"',
            f"`estimateLearningRate = {theirs}`",
            "The same beside estimated scales; ITK ignores it beside a list, and regframe does not.",
            {**SLOPES, "scales": "physical-shift", "optimizer": {**PLAIN, "estimate_learning_rate": when}},
        )
        for when, theirs in (("once", "Once"), ("each-iteration", "EachIteration"))
    ),
    Case(
        "convergence_minimum, convergence_window",
        "`convergenceMinimumValue`, `convergenceWindowSize`",
        "The same window of the last values, judged against the sum of all.",
        {
            **SLOPES,
            "scales": "physical-shift",
            "optimizer": {**PLAIN, "convergence_minimum": 1e-2, "convergence_window": 4},
            "levels": [{"iterations": 30}],
        },
    ),
    Case(
        "weights, frozen",
        "`SetOptimizerWeights`",
        "The same for descents; searches without slopes keep frozen parameters here, which ITK moves.",
        {**SLOPES, "weights": [0.0, 0.0, 1.0, 1.0]},
    ),
    Case(
        'gradient = "filtered"',
        "`SetMetricUseMovingImageGradientFilter`",
        "ITK's default, of a copy smoothed once more; here the exact slope is, so ask for it.",
        SLOPES,
    ),
    Case(
        'gradient = "central"',
        "`SetMetricUseMovingImageGradientFilter(False)`",
        "ITK's other choice: central differences. Ask for it.",
        {**SLOPES, "gradient": "central"},
    ),
    Case(
        "moving_initial, chains",
        "`SetMovingInitialTransform`, `CompositeTransform`",
        "The same map beyond the searched one; the searched one keeps its centre, SimpleITK's does not.",
        placed=_beyond,
    ),
    Case("fixed_initial", "`SetFixedInitialTransform`", "The same; here it must be affine.", placed=_below),
    Case("domain", "`SetVirtualDomain`", "The same grid of samples.", placed=_domain),
    Case(
        "compose",
        "`SetMovingInitialTransform`",
        "The map found before is told as the moving-initial one.",
        STEPPED,
        ({"transform": "translation"}, {"start": "compose"}),
    ),
    Case(
        "update_variance",
        "`SetSmoothingGaussianOnUpdate`",
        "The same, of `displacement-field`; smoothing by B-splines is not offered.",
        {**STEPPED, "transform": {**FIELD, "total_variance": 0.0}},
    ),
    Case(
        "total_variance",
        "`SetSmoothingGaussianOnUpdate`",
        "The same; estimated rates count the smoothing as ITK's do, where scales are ITK's.",
        {**STEPPED, "transform": FIELD, "metric": "mattes"},
    ),
    Case(
        "refine",
        "`SetInitialTransformAsBSpline`",
        "The same; ITK reads splines of order 2 as if they were of order 3 when it lays the lattice anew, "
        "and so does this.",
        {**STEPPED, "transform": MESH, "levels": [{**LEVELS[0], "refine": 1}, {**LEVELS[1], "refine": 2}]},
    ),
    Case(
        "oblique grids",
        "`Image.SetDirection`",
        "The same places to the last bits of a direction's inverse.",
        prepared=_oblique,
    ),
    Case(
        "float32 images",
        "`sitkFloat32`",
        "Interpolated values and their differences are rounded as ITK rounds them.",
        prepared=_single,
    ),
)


def _starts() -> list[Row]:
    import SimpleITK as sitk

    modes = sitk.CenteredTransformInitializerFilter
    found = []
    for start, name, mode in (("centres", "GEOMETRY", modes.GEOMETRY), ("moments", "MOMENTS", modes.MOMENTS)):
        apart = []
        for shape in SHAPES:
            below, above = pair = _oblique(waves(shape))
            images, still = map(convert.image, pair), sitk.AffineTransform(len(shape))
            corners = below.grid.corners()
            ours = _begun(start, "affine", below, above)(corners)
            there = _mapped(sitk.CenteredTransformInitializer(*images, still, mode), corners)
            apart.append(float(np.abs(ours - there).max()))
        twin = f"`CenteredTransformInitializer`, `{name}`"
        found.append(
            Row(f'start = "{start}"', twin, "corners, 2-D and 3-D", largest(apart), "px", "The same.")
        )
    return [*found, *_axes()]


def _axes() -> list[Row]:
    """Principal axes: ITK's turn as it is, and of ours where the centre of mass goes."""
    import SimpleITK as sitk

    below, above = pair = _oblique(waves(SHAPES[1]))
    theirs = sitk.CenteredVersorTransformInitializer(
        *map(convert.image, pair),
        sitk.VersorRigid3DTransform(),
        True,  # type: ignore[call-arg]  # its stub knows two arguments
    )
    ours = {name: _begun(name, "versor-rigid", below, above) for name in ("principal-axes", ITK_AXES)}
    centre, corners = np.atleast_2d(ours["principal-axes"].frame.centre), below.grid.corners()
    apart = [
        float(np.abs(ours[name](points) - _mapped(theirs, points)).max())
        for name, points in (("principal-axes", centre), (ITK_AXES, corners))
    ]
    twin = "`CenteredVersorTransformInitializer`"
    turns = "The same axes; ITK turns the wrong way about them, regframe the right way by the smallest turn."
    return [
        Row('start = "principal-axes"', twin, "the centre of mass, 3-D", apart[0], "px", turns),
        Row(f'start = "{ITK_AXES}"', twin, "corners, 3-D", apart[1], "px", "The same turn, to repeat ITK's."),
    ]


def _begun(start: Any, transform: Any, below: Image, above: Image) -> Warp:
    parts: dict[str, Any] = {"interpolator": "linear", "metric": "mattes", "optimizer": "powell"}
    return begin(Stage(start=start, transform=transform, **parts), below, above, None)


def _mapped(theirs: "sitk.Transform", points: Points) -> Points:
    return np.array([theirs.TransformPoint(list(map(float, point))) for point in points])
