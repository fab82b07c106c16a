"""Small honest components, for planting one fault at a time."""

import numpy as np
from pydantic import Field
from scipy import ndimage

from regframe.interpolators.base import Interpolator
from regframe.metrics.base import Metric
from regframe.optimizers.base import Optimizer, Step
from regframe.transforms.base import Transform


class Difference(Metric):
    """Mean squared difference, infinite without weight (Brown, 1992)."""

    power: float = Field(2.0, description="Exponent of the difference; only 2 has a slope here.")

    def value(self, pairs):
        mass = float(pairs.weight.sum())
        gap = np.abs(pairs.fixed - pairs.moving)
        return float((pairs.weight * gap**self.power).sum() / mass) if mass else float("inf")

    def derivative(self, pairs):
        mass = float(pairs.weight.sum()) or 1.0
        return 2.0 * pairs.weight * (pairs.moving - pairs.fixed) / mass


class Stretch(Transform):
    """One scale for all axes and a shift, about the centre."""

    def identity(self, frame):
        return np.array([1.0, *np.zeros(frame.dim)])

    def names(self, frame):
        return ("scale", *("tx", "ty", "tz")[: frame.dim])

    def map(self, params, points, frame):
        return params[0] * (points - frame.centre) + frame.centre + params[1:]

    def as_affine(self, params, frame):
        from regframe.geometry import AffineMap

        return AffineMap(params[0] * np.eye(frame.dim), frame.centre + params[1:] - params[0] * frame.centre)

    def from_affine(self, affine, frame):
        scale = np.trace(affine.matrix) / frame.dim
        return np.array([scale, *(affine(frame.centre[None])[0] - frame.centre)])


class Tent(Interpolator):
    """Linear interpolation by scipy; the outer half pixel repeats the last value."""

    def sample(self, coefficients, indices):
        return ndimage.map_coordinates(coefficients, indices.T, order=1, mode="nearest")


class Shrinking(Optimizer):
    """Tries a random step, keeps it when it is better, and shortens its reach (Rechenberg, 1973)."""

    reach: float = Field(3.0, gt=0, description="Deviation of the first steps, pixels of motion.")

    def steps(self, problem, start, rng):
        here, value, reach = start.copy(), float(problem.values(start[None])[0]), self.reach
        while reach > 1e-3:
            there = here + reach * rng.standard_normal(len(here))
            met = float(problem.values(there[None])[0])
            if met < value:
                here, value, reach = there, met, reach * 1.5
            else:
                reach *= 0.93
            yield Step(here, value, reach)
        return f"the reach has fallen to {reach:.2g}"
