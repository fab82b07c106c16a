"""What SimpleITK calls each component: one short function a class, and plugins add their own.

A twin is registered for a class, in three lines::

    @twins.metric.register(MyMetric)
    def _(ours: MyMetric, method: twins.Method) -> None:
        method.SetMetricAsMeanSquares()

Nothing heavy is imported here, so a plugin may do this beside its component.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import singledispatch
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from regframe.catalog import KINDS
from regframe.component import Component
from regframe.errors import NoTwin, PresetError
from regframe.geometry import Frame
from regframe.interpolators.base import Interpolator
from regframe.metrics.base import Metric, Pairs
from regframe.optimizers.base import Optimizer
from regframe.preset import Stage
from regframe.registry import AnyRegistry
from regframe.transforms.base import Transform
from regframe.transforms.warp import Warp
from regframe.types import Mask, Params

if TYPE_CHECKING:
    import SimpleITK as sitk

NEWTON = 40
"""Rounds of a Newton iteration with the slopes at its start, enough for steps below one."""

Method: TypeAlias = "sitk.ImageRegistrationMethod"


@dataclass(frozen=True)
class Terms:
    """A stage said in ITK's own terms, so that both engines can walk it alike.

    Parameters
    ----------
    stage : Stage
    notes : tuple of str
        What had to be said otherwise.
    alike : bool
        Whether both engines take the same steps; if not, only answers can be compared.
    scaled : bool
        Whether SimpleITK may be told scales; with L-BFGS-B they end the process.
    together : bool
        Whether one call may run several levels.
    draws : bool
        Whether the optimizer draws random numbers, whose course ends with a call.
    remembers : bool
        Whether ITK ends a level at the position after the step from the lowest value met. Its events tell
        the current one, and regframe the one to end at.
    weights : tuple of float
        Factors on the slopes that SimpleITK is told; none when all are 1.
    """

    stage: Stage
    notes: tuple[str, ...] = field(default=())
    alike: bool = True
    scaled: bool = True
    together: bool = True
    draws: bool = False
    remembers: bool = False
    weights: tuple[float, ...] = ()


@singledispatch
def metric(ours: Metric, method: "Method") -> None:
    """Tell SimpleITK the metric.

    Raises
    ------
    NoTwin
        SimpleITK has none such.
    """
    raise _missing(metric.registry, ours)


@singledispatch
def interpolator(ours: Interpolator) -> str:
    """SimpleITK's name of the interpolator, such as ``sitkLinear``.

    Raises
    ------
    NoTwin
    """
    raise _missing(interpolator.registry, ours)


@singledispatch
def transform(ours: Transform, frame: Frame) -> "sitk.Transform":
    """SimpleITK's transform of the same parameters, about the frame's centre; parameters come later.

    Raises
    ------
    NoTwin
    """
    raise _missing(transform.registry, ours)


@singledispatch
def optimizer(ours: Optimizer, method: "Method", iterations: int, seed: int) -> None:
    """Tell SimpleITK the optimizer.

    Raises
    ------
    NoTwin
    """
    raise _missing(optimizer.registry, ours)


@singledispatch
def terms(ours: Optimizer, stage: Stage, unit: Params) -> Terms:
    """The stage of an optimizer in ITK's terms.

    Parameters
    ----------
    unit : (p,) float64
        Pixels (or mm) of motion per unit of each parameter, ones unless the stage's scales are `shift`.

    Raises
    ------
    NoTwin
        Steps in pixels of motion, of an optimizer that does not tell what they are in ITK.
    """
    if stage.scales == "shift":
        message = (
            f'{type(ours).__name__} does not say what scales = "shift" is in SimpleITK. Give `scales` as a '
            f"list or an estimator's name, or register `regframe.peer.twins.terms` for it."
        )
        raise NoTwin(message)
    return Terms(stage)


@singledispatch
def held(ours: Optimizer, stage: Stage, free: Mask) -> tuple[Stage, str]:
    """The stage of an optimizer without weights, its frozen parameters said in ITK's terms, and a note.

    Parameters
    ----------
    stage : Stage
        Its scales are a list.
    free : (p,) bool

    Raises
    ------
    NoTwin
        SimpleITK's optimizer cannot keep a parameter as it is.
    """
    message = (
        f"SimpleITK's twin of {type(ours).__name__} cannot freeze parameters. Search them all, choose an "
        "optimizer that walks along slopes, or use the native engine."
    )
    raise NoTwin(message)


@singledispatch
def counted(ours: Metric, pairs: Pairs) -> int:
    """How many samples a metric counts: those with weight, unless it drops more."""
    return int(np.count_nonzero(pairs.weight))


@singledispatch
def sloped(ours: Metric) -> Metric:
    """The metric with ITK's derivative, where its own is another one."""
    return ours


@singledispatch
def summed(ours: Metric) -> bool:
    """Whether ITK's slope by a displacement field is a sum over samples, where by other maps it is a mean."""
    return False


@singledispatch
def adding(ours: Transform) -> Transform:
    """The family whose steps are sums, of one that smooths them: the same map at the same parameters."""
    return ours


def step(warp: Warp, after: Params) -> Params:
    """The step that an ITK optimizer made to get from a warp's parameters to others.

    Their difference, but for families whose `advance` composes rotations: there it is solved for.
    """
    ours, before, frame = warp.transform, warp.params, warp.frame
    found = after - before
    if type(ours).advance is Transform.advance or (ours == adding(ours) and ours.local):
        return found
    small = 1e-6
    ahead = [ours.advance(before, small * axis, frame) - before for axis in np.eye(len(before))]
    slopes = np.array(ahead).T / small
    for _ in range(NEWTON):
        found = found + np.linalg.solve(slopes, after - ours.advance(before, found, frame))
    return found


def _missing(table: Mapping[Any, object], ours: Component) -> NoTwin:
    registry = next(each for each in KINDS.values() if isinstance(ours, each.base))
    known = ", ".join(sorted(_called(registry, cls) for cls in table if cls not in {registry.base, object}))
    kind, cls, name = registry.kind, type(ours), _called(registry, type(ours))
    return NoTwin(
        f"SimpleITK has no twin of the {kind} {name}. Those with one: {known}. Choose one of them, use the "
        f"native engine, or register a twin: @regframe.peer.twins.{kind}.register({cls.__name__})."
    )


def _called(registry: AnyRegistry, cls: type[Component]) -> str:
    """The name in a preset; of a class that has none, its own."""
    try:
        return registry.name_of(cls)
    except PresetError:
        return cls.__name__
