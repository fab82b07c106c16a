"""A stage told to SimpleITK's registration method, part by part."""

from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from regframe.engine.followed import followed
from regframe.engine.scales import Coordinates, coordinates
from regframe.engine.setting import Setting, taken_up
from regframe.errors import NoTwin
from regframe.image import Image
from regframe.kernels.sharing import threads
from regframe.optimizers.base import Optimizer
from regframe.optimizers.gradient_descent import GradientDescent
from regframe.optimizers.regular_step_gradient_descent import RegularStepGradientDescent
from regframe.peer import convert, twins
from regframe.peer.twins import Terms
from regframe.preset import Level, Stage
from regframe.transforms.base import Transform
from regframe.transforms.bspline import BSpline
from regframe.transforms.displacement_field import DisplacementField
from regframe.transforms.warp import Warp

if TYPE_CHECKING:
    import SimpleITK as sitk

    from regframe.peer.twins import Method

SUMMED = (
    "SimpleITK's slopes of this metric by a field are not divided by the samples, and the size of a slope "
    "matters here"
)


@dataclass(frozen=True)
class Part:
    """Levels of a stage that one call of SimpleITK can run, their sampling seed, and what stays around."""

    stage: Stage
    levels: tuple[Level, ...]
    seed: int
    setting: Setting


def in_its_terms(stage: Stage, warp: Warp, moving: Image, setting: Setting) -> Terms:
    """The stage as SimpleITK can run it from a warp, with notes on what is said otherwise.

    Raises
    ------
    NoTwin
    PresetError
        A list of scales of the wrong length: SimpleITK would take ones in silence.
    GeometryError
        A parameter that moves nothing.
    """
    if stage.proof is not None:
        message = (
            "SimpleITK does not judge a stage by parts of the image that its fit did not see. Leave `proof` "
            "out, or take the native engine."
        )
        raise NoTwin(message)
    if any(level.fit is not None or level.optimizer is not None or level.carried for level in stage.levels):
        message = (
            "SimpleITK has levels by whole `shrink` factors, one optimizer for all of them, and the metric "
            "itself. Leave the levels' `fit`, `optimizer` and `carried` out, or take the native engine."
        )
        raise NoTwin(message)
    if stage.scales == "grid-shift":
        message = 'SimpleITK does not step by grid points. Write scales = "shift", or take the native engine.'
        raise NoTwin(message)
    grid, warp = setting.domain.coarsen(stage.levels[0].shrink), taken_up(warp, setting, stage.levels[0])
    whole = followed(stage, setting.beyond)
    space, _ = coordinates(whole, warp.params, warp.frame, grid, moving.grid)
    if stage.scales == "shift" and np.allclose(space.unit, 1.0, rtol=0, atol=1e-6):
        # A translation's parameters are motion already.
        stage = stage.model_copy(update={"scales": (1.0,) * len(space.unit)})
    terms = _weighed(twins.terms(stage.optimizer, stage, space.unit), space)
    return _of_points(terms, warp.frame.dim) if stage.transform.local else terms


def _of_points(terms: Terms, dim: int) -> Terms:
    """The terms of a family with parameters at every point: ITK's numbers are one an axis.

    Raises
    ------
    NoTwin
    """
    stage, notes, alike = terms.stage, terms.notes, terms.alike
    optimizer = stage.optimizer
    numbers = stage.scales if isinstance(stage.scales, tuple) else ()
    uneven = any(
        listed != listed[:dim] * (len(listed) // dim) for listed in (numbers, terms.weights) if listed
    )
    # It asks its regular steps for a scale a parameter there, and then finds that these are too many.
    walks = optimizer.weighs and not isinstance(optimizer, RegularStepGradientDescent)
    if not walks or uneven or any(level.sampling != "all" for level in stage.levels):
        message = (
            "SimpleITK fits displacement fields by gradient descent, with line searches or without, on every "
            f"grid point, and weighs axes but not points. Got {type(optimizer).__name__}. Change that part, "
            "or use the native engine."
        )
        raise NoTwin(message)
    if twins.summed(stage.metric) and not _sizeless(optimizer, stage.transform):
        notes = (*notes, SUMMED)
        alike = False
    if numbers:
        stage = stage.model_copy(update={"scales": numbers[:dim]})
    return replace(terms, stage=stage, notes=notes, alike=alike, weights=terms.weights[:dim])


def _sizeless(optimizer: Optimizer, family: Transform) -> bool:
    """Whether a descent's steps do not depend on the size of slopes, as ITK estimates their rates."""
    # What smoothing the whole field moves is measured along with a step, however short that is.
    elastic = isinstance(family, DisplacementField) and family.total_variance > 0
    even = isinstance(optimizer, GradientDescent) and optimizer.estimate_learning_rate == "each-iteration"
    return even and not elastic


def _weighed(terms: Terms, space: Coordinates) -> Terms:
    """The terms with what they say of weights and frozen parameters."""
    stage = terms.stage
    if stage.optimizer.weighs:
        return terms if np.all(space.weights == 1.0) else replace(terms, weights=tuple(space.weights))
    if not stage.frozen:
        return terms
    scales = stage.scales if isinstance(stage.scales, tuple) else tuple(map(float, space.scales))
    stage, note = twins.held(stage.optimizer, stage.model_copy(update={"scales": scales}), space.free)
    return replace(terms, stage=stage.model_copy(update={"frozen": ()}), notes=(*terms.notes, note))


def told(part: Part, fixed: Image, moving: Image) -> "Method":
    """A method that knows metric, interpolator, masks, pyramid, samples and slopes; no optimizer yet."""
    import SimpleITK as sitk

    stage, levels, domain = part.stage, part.levels, part.setting.domain
    method = sitk.ImageRegistrationMethod()
    method.SetNumberOfThreads(threads())
    method.SetInterpolator(getattr(sitk, twins.interpolator(stage.interpolator)))
    twins.metric(stage.metric, method)
    if fixed.mask is not None:
        method.SetMetricFixedMask(convert.mask(fixed.mask, fixed.grid))
    if moving.mask is not None:
        method.SetMetricMovingMask(convert.mask(moving.mask, moving.grid))
    if domain != fixed.grid:
        direction = [entry for row in domain.direction for entry in row]
        method.SetVirtualDomain(list(reversed(domain.shape)), domain.origin, domain.spacing, direction)
    kinds = {"all": method.NONE, "regular": method.REGULAR, "random": method.RANDOM}
    method.SetMetricSamplingStrategy(kinds[levels[0].sampling])
    method.SetMetricSamplingPercentagePerLevel([level.fraction for level in levels], part.seed)
    method.SetShrinkFactorsPerLevel([level.shrink for level in levels])
    method.SetSmoothingSigmasPerLevel([level.smooth for level in levels])
    method.SetSmoothingSigmasAreSpecifiedInPhysicalUnits(stage.smooth_unit == "physical")
    # Off for searches without slopes too: it needs four pixels an axis and a gradient image a level.
    method.SetMetricUseMovingImageGradientFilter(stage.gradient == "filtered")
    method.SetMetricUseFixedImageGradientFilter(stage.gradient == "filtered")
    return method


def put(method: "Method", part: Part, warp: Warp, *, adapting: bool = False) -> "sitk.Transform":
    """Tell a method all maps; what is given back is the searched one, which it changes in place.

    Parameters
    ----------
    warp : Warp
        As a level has taken it up; or, where the method is `adapting`, as it is before the part's levels.
    """
    setting = part.setting
    if adapting and warp.transform.local:
        # It shrinks the grid of the field that it is given.
        params, frame = warp.transform.adapted(warp.params, warp.frame, setting.domain, None)
        warp = Warp(warp.transform, params, frame)
    moved = convert.transform(warp)
    if setting.below is not None:
        method.SetFixedInitialTransform(convert.transform(setting.below))
    if setting.beyond is not None:
        method.SetMovingInitialTransform(convert.centred(setting.beyond, warp.frame))
    factors = _factors(part, warp) if adapting else []
    if any(factors):
        method.SetInitialTransformAsBSpline(moved, True, factors)
    else:
        method.SetInitialTransform(moved, True)
    return moved


def _factors(part: Part, warp: Warp) -> list[int]:
    """By how much each level divides the cells that a B-spline has before them; 0 leaves them.

    Raises
    ------
    NoTwin
        A later level is to be coarser, or finer by no whole number, than one of another call before it.
    """
    levels, family = part.levels, warp.transform
    if not isinstance(family, BSpline) or all(level.refine is None for level in levels):
        return []
    now = 1
    if warp.frame.lattice is not None:
        now = max((warp.frame.lattice.shape[-1] - family.order) // family.mesh[0], 1)
    wanted = [level.refine or 0 for level in levels]
    if any(factor % now for factor in wanted):
        message = (
            f"SimpleITK multiplies the cells that a call begins with, here {now} times the mesh, so it "
            f"cannot refine by {wanted}. Give all levels equal `iterations` and `sampling`: then they are "
            "one call."
        )
        raise NoTwin(message)
    return [factor // now for factor in wanted]


def tell_optimizer(method: "Method", terms: Terms, iterations: int, seed: int) -> None:
    """Tell a method the optimizer, and its scales where it bears them."""
    twins.optimizer(terms.stage.optimizer, method, iterations, seed)
    scales = terms.stage.scales
    if terms.weights:
        method.SetOptimizerWeights(list(terms.weights))
    if not terms.scaled:
        return
    if isinstance(scales, tuple):
        method.SetOptimizerScales(list(scales))
        return
    estimators: dict[str, Callable[[], None]] = {
        "physical-shift": method.SetOptimizerScalesFromPhysicalShift,
        "index-shift": method.SetOptimizerScalesFromIndexShift,
        "jacobian": method.SetOptimizerScalesFromJacobian,
    }
    estimators[scales]()


def parts(terms: Terms, seed: int, setting: Setting) -> list[Part]:
    """Runs of levels that SimpleITK can make in one call: equal iterations and kind of sampling."""
    stage = terms.stage
    found: list[list[Level]] = []
    for level in stage.levels:
        last = found[-1][-1] if found else None
        if terms.together and last and (last.iterations, last.sampling) == (level.iterations, level.sampling):
            found[-1].append(level)
        else:
            found.append([level])
    whole = []
    for levels in found:
        whole.append(Part(stage, tuple(levels), seed, setting))
        seed += len(levels) * seeds_used(levels[0])
    return whole


def seeds_used(level: Level) -> int:
    """Sampling seeds that a level uses up, in ITK and in ours."""
    return {"all": 0, "regular": 1, "random": 2}[level.sampling]


@contextmanager
def steady() -> Generator[None, None, None]:
    """Keep ITK's warnings off the terminal, and its metrics to our number of threads.

    What it warns of shows in values and counts. A method's own number of threads does not reach its metric,
    whose sums depend on it in their last bits.
    """
    import SimpleITK as sitk

    process = sitk.ProcessObject
    shown, count = process.GetGlobalWarningDisplay(), process.GetGlobalDefaultNumberOfThreads()
    process.SetGlobalWarningDisplay(False)
    process.SetGlobalDefaultNumberOfThreads(threads())
    try:
        yield
    finally:
        process.SetGlobalWarningDisplay(shown)
        process.SetGlobalDefaultNumberOfThreads(count)
