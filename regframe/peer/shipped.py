"""Twins of the metrics, interpolators and transforms that regframe ships, three lines each."""

from typing import TYPE_CHECKING

import numpy as np

from regframe.geometry import Frame
from regframe.interpolators.bspline import BSpline
from regframe.interpolators.linear import Linear
from regframe.interpolators.nearest import Nearest
from regframe.metrics.base import Pairs
from regframe.metrics.correlation import Correlation
from regframe.metrics.mattes import Mattes
from regframe.metrics.mean_squares import MeanSquares
from regframe.peer import twins
from regframe.transforms.affine import Affine
from regframe.transforms.rigid import Rigid
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation

if TYPE_CHECKING:
    import SimpleITK as sitk

    from regframe.peer.twins import Method


@twins.metric.register(Correlation)
def _(ours: Correlation, method: "Method") -> None:
    method.SetMetricAsCorrelation()


@twins.metric.register(Mattes)
def _(ours: Mattes, method: "Method") -> None:
    method.SetMetricAsMattesMutualInformation(ours.bins)


@twins.counted.register(Mattes)
def _(ours: Mattes, pairs: Pairs) -> int:
    low, high = pairs.moving_range
    return int(np.count_nonzero((pairs.weight > 0) & (pairs.moving >= low) & (pairs.moving <= high)))


@twins.metric.register(MeanSquares)
def _(ours: MeanSquares, method: "Method") -> None:
    method.SetMetricAsMeanSquares()


@twins.interpolator.register(BSpline)
def _(ours: BSpline) -> str:
    return f"sitkBSpline{ours.order}" if ours.order else "sitkNearestNeighbor"


@twins.interpolator.register(Linear)
def _(ours: Linear) -> str:
    return "sitkLinear"


@twins.interpolator.register(Nearest)
def _(ours: Nearest) -> str:
    return "sitkNearestNeighbor"


@twins.transform.register(Affine)
def _(ours: Affine, frame: Frame) -> "sitk.Transform":
    return _centred("AffineTransform", frame, frame.dim)


@twins.transform.register(Rigid)
def _(ours: Rigid, frame: Frame) -> "sitk.Transform":
    return _centred("Euler2DTransform", frame)


@twins.transform.register(Similarity)
def _(ours: Similarity, frame: Frame) -> "sitk.Transform":
    return _centred("Similarity2DTransform", frame)


@twins.transform.register(Translation)
def _(ours: Translation, frame: Frame) -> "sitk.Transform":
    import SimpleITK as sitk

    return sitk.TranslationTransform(frame.dim)


def _centred(name: str, frame: Frame, *arguments: int) -> "sitk.Transform":
    import SimpleITK as sitk

    theirs = getattr(sitk, name)(*arguments)
    theirs.SetCenter(frame.centre.tolist())
    made: sitk.Transform = theirs
    return made
