"""Correlation in a window around every point."""

from typing import ClassVar, Literal, NamedTuple, final

import numpy as np
from pydantic import Field

from regframe.metrics.base import Metric, Pairs
from regframe.types import Mask, Values, Volume

EPSILON = float(np.finfo(np.float64).eps)
FLAT = 1e-10  # of the image's own variance; running sums leave less than this of a constant window


@final
class AntsCorrelation(Metric):
    """Minus the mean squared correlation in windows around every grid point, in [-1, 0].

    Avants, Epstein, Grossman and Gee, "Symmetric diffeomorphic image registration with cross-correlation",
    Medical Image Analysis 12(1), 2008; ITK's ANTSNeighborhoodCorrelationImageToImageMetricv4. Brightness
    and contrast, and even its sign, may change slowly across the image. Windows end at the grid's border
    and leave out samples of weight 0; a window in which an image is constant scores as a perfect one, as
    in ITK, so mask out empty background. Without any sample the value is infinite. Departures from ITK:
    the exact slope is the default, ITK's derivative is minus ours, constant means "within 1e-10 of the
    image's variance", and products of float32 intensities are not rounded.
    """

    radius: int = Field(
        4, ge=1, le=64, description="Of the windows, in grid points: 2 radius + 1 points along each axis."
    )
    slope: Literal["exact", "itk"] = Field(
        "exact",
        description=(
            "What gradient optimizers follow: the slope of the value, or ITK's, in which an intensity has a "
            "say in the window around itself alone."
        ),
    )

    layout: ClassVar[Literal["points", "grid"]] = "grid"
    suits: ClassVar[tuple[str, ...]] = ("mono", "inverted")
    invariant_to: ClassVar[tuple[str, ...]] = ("shift", "scale", "inversion")

    def value(self, pairs: Pairs) -> float:
        """- sum of w cc / sum of w, with cc = cov(f, m)^2 / (var(f) var(m)) in the window of each point."""
        return _value(_windows(pairs, self.radius))

    def derivative(self, pairs: Pairs) -> Values:
        """Slope of the value by each moving intensity."""
        return self.value_and_derivative(pairs)[1]

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Values]:
        """The value, and its slope by each moving intensity.

        With a = 2 cov / (vf vm) and b = a cov / vm in the window of a centre c, and primes about the
        window's means, d cc(c) / d m(j) = w(j) (a f'(j) - b m'(j)) for every j of the window. The exact
        slope sums this over all c around j, ITK takes c = j alone.
        """
        at = _windows(pairs, self.radius)
        mass = float(at.weight.sum())
        if not mass:
            return float("inf"), np.zeros_like(pairs.moving)
        vary = at.varies
        first = 2.0 * at.covariance * _inverse(at.fixed_power * at.moving_power, vary)
        second = first * at.covariance * _inverse(at.moving_power, vary)
        terms = [first, second, first * at.fixed_mean - second * at.moving_mean]
        if self.slope == "exact":
            terms = [_box(at.weight * term, self.radius) for term in terms]
        slopes = terms[0] * at.fixed - terms[1] * at.moving - terms[2]
        return _value(at), (slopes * at.weight / -mass).ravel()


class Windows(NamedTuple):
    """The grid's samples and the moments of the window around each."""

    fixed: Volume  # about the mean of the image, 0 where the weight is
    moving: Volume
    weight: Volume  # at most 1
    fixed_mean: Volume
    moving_mean: Volume
    covariance: Volume  # sums of products about the window's means
    fixed_power: Volume
    moving_power: Volume
    varies: Mask  # neither image is constant in the window


def _windows(pairs: Pairs, radius: int) -> Windows:
    shape = pairs.shape or pairs.weight.shape  # layout "grid" always has a shape
    weight = pairs.weight / (float(pairs.weight.max()) or 1.0)
    mass = float(weight.sum()) or 1.0
    # About the means of the images, so that the differences of sums below lose no digits.
    fixed, moving = (
        np.where(weight > 0.0, values - float(np.sum(weight * values)) / mass, 0.0).reshape(shape)
        for values in (pairs.fixed, pairs.moving)
    )
    weight = weight.reshape(shape)
    per_count = _inverse(_box(weight, radius), weight > 0.0)
    fixed_sum, moving_sum = _box(weight * fixed, radius), _box(weight * moving, radius)
    means = fixed_sum * per_count, moving_sum * per_count
    covariance = _box(weight * fixed * moving, radius) - fixed_sum * means[1]
    fixed_power = _box(weight * fixed * fixed, radius) - fixed_sum * means[0]
    moving_power = _box(weight * moving * moving, radius) - moving_sum * means[1]
    varies = (weight > 0.0) & (fixed_power * moving_power > EPSILON)
    for values, power in ((fixed, fixed_power), (moving, moving_power)):
        varies &= power * per_count > FLAT * float(np.sum(weight * values * values)) / mass
    return Windows(fixed, moving, weight, *means, covariance, fixed_power, moving_power, varies)


def _value(at: Windows) -> float:
    mass = float(at.weight.sum())
    if not mass:
        return float("inf")
    squared = at.covariance * at.covariance * _inverse(at.fixed_power * at.moving_power, at.varies)
    return -float(np.sum(at.weight * np.where(at.varies, squared, 1.0))) / mass


def _inverse(values: Volume, where: Mask) -> Volume:
    """One divided by values, 0 elsewhere."""
    return np.divide(1.0, values, out=np.zeros_like(values), where=where)


def _box(values: Volume, radius: int) -> Volume:
    """Sums over the window of each point, which ends at the border, by running sums along each axis."""
    for axis, length in enumerate(values.shape):
        lines = np.moveaxis(values, axis, 0)
        # Sums of all points before a place; before the border 0, beyond it all.
        running = np.zeros((length + 2 * radius + 1, *lines.shape[1:]))
        np.cumsum(lines, axis=0, out=running[radius + 1 : radius + 1 + length])
        running[radius + 1 + length :] = running[radius + length]
        values = np.moveaxis(running[2 * radius + 1 :] - running[:length], 0, axis)
    return np.ascontiguousarray(values)
