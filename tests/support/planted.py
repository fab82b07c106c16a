"""Components with one fault each, and honest twins, for a cross-check to catch."""

from typing import ClassVar

import numpy as np

from regframe.interpolators.base import Interpolator
from regframe.interpolators.linear import Linear
from regframe.metrics.base import Metric, Pairs
from regframe.metrics.mattes import Mattes
from regframe.metrics.mean_squares import MeanSquares
from regframe.metrics.parzen_histogram import joint_of
from regframe.peer import twins
from regframe.transforms.base import Transform
from regframe.transforms.similarity import Similarity


class HalfPixel(Interpolator):
    """Linear, but pixels are taken for their corners."""

    def sample(self, coefficients, indices):
        return Linear().sample(coefficients, np.ascontiguousarray(indices - 0.5))


class WrongSign(Metric):
    """Mean squares whose derivative points downhill."""

    def value(self, pairs):
        return MeanSquares().value(pairs)

    def derivative(self, pairs):
        return -MeanSquares().derivative(pairs)


class Swapped(Metric):
    """Mattes' with the marginals taken for each other."""

    bins: int = 50
    suits: ClassVar[tuple[str, ...]] = ("multimodal",)

    def prepare(self, pairs: Pairs):
        return Mattes(bins=self.bins).prepare(pairs)

    def value(self, pairs):
        joint, _ = joint_of(pairs, self.bins)
        rows, columns = joint.sum(axis=0), joint.sum(axis=1)
        met = joint > 0
        expected = np.outer(rows, columns)
        met &= expected > 0
        return -float(np.sum(joint[met] * np.log(joint[met] / expected[met])))


class Degrees(Transform):
    """A similarity whose angle is in degrees."""

    dimensions: ClassVar[tuple[int, ...]] = (2,)

    def identity(self, frame):
        return Similarity().identity(frame)

    def names(self, frame):
        return ("scale", "angle_deg", "tx", "ty")

    def map(self, params, points, frame):
        return Similarity().map(_in_radians(params), points, frame)

    def as_affine(self, params, frame):
        return Similarity().as_affine(_in_radians(params), frame)


def _in_radians(params):
    return np.array([params[0], np.deg2rad(params[1]), *params[2:]])


@twins.interpolator.register(HalfPixel)
def _(_ours):
    return "sitkLinear"


@twins.metric.register(WrongSign)
def _(_ours, method):
    method.SetMetricAsMeanSquares()


@twins.metric.register(Swapped)
def _(ours, method):
    method.SetMetricAsMattesMutualInformation(ours.bins)


@twins.counted.register(Swapped)
def _(ours, pairs):
    return twins.counted(Mattes(bins=ours.bins), pairs)


@twins.transform.register(Degrees)
def _(_ours, frame):
    return twins.transform(Similarity(), frame)
