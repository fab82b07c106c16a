"""Twins of the metrics, interpolators and transforms that regframe ships, three lines each."""

from typing import TYPE_CHECKING

import numpy as np

from regframe.errors import NoTwin
from regframe.geometry import Frame
from regframe.interpolators.bspline import BSpline
from regframe.interpolators.gaussian import Gaussian
from regframe.interpolators.label_gaussian import LabelGaussian
from regframe.interpolators.linear import Linear
from regframe.interpolators.nearest import Nearest
from regframe.interpolators.windowed_sinc import WindowedSinc
from regframe.metrics.ants_correlation import AntsCorrelation
from regframe.metrics.base import Metric, Pairs
from regframe.metrics.correlation import Correlation
from regframe.metrics.demons import Demons
from regframe.metrics.itk_joint_histogram_mi import ItkJointHistogramMi
from regframe.metrics.mattes import Mattes
from regframe.metrics.mean_squares import MeanSquares
from regframe.peer import twins
from regframe.transforms import itk
from regframe.transforms.bspline import BSpline as BSplineTransform
from regframe.transforms.displacement_field import DisplacementField

if TYPE_CHECKING:
    import SimpleITK as sitk

    from regframe.peer.twins import Method


@twins.metric.register(AntsCorrelation)
def _(ours: AntsCorrelation, method: "Method") -> None:
    method.SetMetricAsANTSNeighborhoodCorrelation(ours.radius)


@twins.metric.register(Correlation)
def _(ours: Correlation, method: "Method") -> None:
    method.SetMetricAsCorrelation()


@twins.metric.register(Demons)
def _(ours: Demons, method: "Method") -> None:
    method.SetMetricAsDemons(ours.threshold)


@twins.metric.register(Mattes)
def _(ours: Mattes, method: "Method") -> None:
    method.SetMetricAsMattesMutualInformation(ours.bins)


@twins.counted.register(Mattes)
def _(ours: Mattes, pairs: Pairs) -> int:
    low, high = pairs.moving_range
    return int(np.count_nonzero((pairs.weight > 0) & (pairs.moving >= low) & (pairs.moving <= high)))


@twins.metric.register(ItkJointHistogramMi)
def _(ours: ItkJointHistogramMi, method: "Method") -> None:
    method.SetMetricAsJointHistogramMutualInformation(ours.bins, ours.variance)


@twins.sloped.register(AntsCorrelation)
@twins.sloped.register(ItkJointHistogramMi)
def _(ours: AntsCorrelation | ItkJointHistogramMi) -> Metric:
    return ours.model_copy(update={"slope": "itk"})


@twins.metric.register(MeanSquares)
def _(ours: MeanSquares, method: "Method") -> None:
    method.SetMetricAsMeanSquares()


@twins.summed.register(AntsCorrelation)
@twins.summed.register(ItkJointHistogramMi)
@twins.summed.register(MeanSquares)
def _(ours: AntsCorrelation | ItkJointHistogramMi | MeanSquares) -> bool:
    return True


@twins.summed.register(Correlation)
def _(ours: Correlation) -> bool:
    message = (
        "SimpleITK's slope of the correlation by a displacement field is not the slope of its value. Choose "
        "another metric, or use the native engine."
    )
    raise NoTwin(message)


@twins.interpolator.register(BSpline)
def _(ours: BSpline) -> str:
    return f"sitkBSpline{ours.order}" if ours.order else "sitkNearestNeighbor"


@twins.interpolator.register(Linear)
def _(ours: Linear) -> str:
    return "sitkLinear"


@twins.interpolator.register(Nearest)
def _(ours: Nearest) -> str:
    return "sitkNearestNeighbor"


@twins.interpolator.register(Gaussian)
@twins.interpolator.register(LabelGaussian)
def _(ours: Gaussian | LabelGaussian) -> str:
    if ours != type(ours)():
        message = (
            f"SimpleITK's {type(ours).__name__} interpolator has no options, its sigma and cutoff are those "
            f"that are default here. Got sigma {ours.sigma:g}, cutoff {ours.cutoff:g}. Leave them out."
        )
        raise NoTwin(message)
    return f"sitk{type(ours).__name__}"


@twins.interpolator.register(WindowedSinc)
def _(ours: WindowedSinc) -> str:
    return f"sitk{ours.window.capitalize()}WindowedSinc"


for _family in {family for family, _ in itk.KINDS}:
    twins.transform.register(_family, itk.made)
twins.transform.register(BSplineTransform, itk.made)


@twins.adding.register(DisplacementField)
def _(ours: DisplacementField) -> DisplacementField:
    return DisplacementField()


@twins.transform.register(DisplacementField)
def _(ours: DisplacementField, frame: Frame) -> "sitk.Transform":
    import SimpleITK as sitk

    theirs = itk.made(ours, frame)
    if ours.update_variance or ours.total_variance:
        assert isinstance(theirs, sitk.DisplacementFieldTransform)
        theirs.SetSmoothingGaussianOnUpdate(ours.update_variance, ours.total_variance)
    return theirs
