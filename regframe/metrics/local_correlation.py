"""Correlation under a Gaussian window around every point."""

from typing import ClassVar, Literal, NamedTuple, final

import numpy as np
from pydantic import Field

from regframe.kernels import fir
from regframe.metrics.base import Metric, Pairs
from regframe.types import Matrix, Values, Volume


@final
class LocalCorrelation(Metric):
    """Minus the mean correlation under Gaussian windows around every grid point, signed or squared.

    Cachier and Pennec, "3D non-rigid registration by gradient descent on a Gaussian-windowed similarity
    measure using convolutions", MMBIA 2000. It differs from `ants-correlation` in three ways: windows have no
    edges, so the value is smooth; variances count from a floor of noise on, so places without detail
    count 0 and not as perfect matches; and it can hold to the sign of contrast. Windows end at the grid's
    border and leave out samples of weight 0. Without any weight the value is infinite.
    """

    sigma: float = Field(4.0, gt=0, le=64, description="Of the windows, in grid points.")
    contrast: Literal["any", "same", "inverted"] = Field(
        "any",
        description=(
            "`any` squares the correlation, so that every place may have its own sign; `same` and `inverted` "
            "hold all places to one."
        ),
    )
    noise: float = Field(
        0.01, gt=0, le=1, description="Standard deviation taken for noise, as a share of an image's range."
    )

    layout: ClassVar[Literal["points", "grid"]] = "grid"

    @property
    def suits(self) -> tuple[str, ...]:  # type: ignore[override]  # it goes by the option
        """What the contrast allows."""
        return {"any": ("mono", "inverted"), "same": ("mono",), "inverted": ("inverted",)}[self.contrast]

    @property
    def invariant_to(self) -> tuple[str, ...]:  # type: ignore[override]  # the same
        """Brightness and contrast; its sign only where that is free."""
        return ("shift", "scale", "inversion") if self.contrast == "any" else ("shift", "scale")

    def value(self, pairs: Pairs) -> float:
        """- sum of w c / sum of w, with c = r, - r or r^2 and r = cov(f, m) / sqrt((vf + e) (vm + e'))."""
        return self._value(self._windows(pairs))

    def derivative(self, pairs: Pairs) -> Values:
        """Slope of the value by each moving intensity."""
        return self.value_and_derivative(pairs)[1]

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Values]:
        """The value, and its slope by each moving intensity.

        With primes about a window's means and s = d c / d r at its centre, d c / d m(j) = w(j) G(j) / mass
        times (a f'(j) - b m'(j)), where a = s / sqrt((vf + e)(vm + e')) and b = s r / (vm + e'). Sums over
        all windows that hold j are convolutions with the window again.
        """
        at = self._windows(pairs)
        mass = float(at.weight.sum())
        if not mass:
            return float("inf"), np.zeros_like(pairs.moving)
        share = at.weight * at.per_mass
        if self.contrast == "any":
            share *= 2.0 * at.correlation
        elif self.contrast == "inverted":
            share *= -1.0
        first = share * at.scale
        second = share * at.correlation / at.moving_power
        terms = self._blurred(np.stack([first, second, first * at.fixed_mean - second * at.moving_mean]))
        slopes = terms[0] * at.fixed - terms[1] * at.moving - terms[2]
        return self._value(at), (slopes * at.weight / -mass).ravel()

    def _value(self, at: "Windows") -> float:
        mass = float(at.weight.sum())
        if not mass:
            return float("inf")
        count = {"any": at.correlation**2, "same": at.correlation, "inverted": -at.correlation}
        return -float(np.sum(at.weight * count[self.contrast])) / mass

    def _windows(self, pairs: Pairs) -> "Windows":
        shape = pairs.shape or pairs.weight.shape  # layout "grid" always has a shape
        weight = pairs.weight / (float(pairs.weight.max()) or 1.0)
        mass = float(weight.sum()) or 1.0
        # About the means of the images, so that the differences of sums below lose no digits.
        fixed, moving = (
            np.where(weight > 0.0, values - float(np.sum(weight * values)) / mass, 0.0).reshape(shape)
            for values in (pairs.fixed, pairs.moving)
        )
        weight = weight.reshape(shape)
        parts = (np.ones_like(weight), fixed, moving, fixed * moving, fixed * fixed, moving * moving)
        masses, *sums = self._blurred(np.stack([weight * part for part in parts]))
        per_mass = np.divide(1.0, masses, out=np.zeros_like(masses), where=weight > 0.0)
        fixed_mean, moving_mean, both, fixed_power, moving_power = (part * per_mass for part in sums)
        covariance = both - fixed_mean * moving_mean
        fixed_power = np.maximum(fixed_power - fixed_mean**2, 0.0) + self._floor(pairs.fixed_range)
        moving_power = np.maximum(moving_power - moving_mean**2, 0.0) + self._floor(pairs.moving_range)
        scale = 1.0 / np.sqrt(fixed_power * moving_power)
        means = (fixed_mean, moving_mean)
        return Windows(fixed, moving, weight, per_mass, *means, covariance * scale, scale, moving_power)

    def _floor(self, span: tuple[float, float]) -> float:
        return (self.noise * (span[1] - span[0])) ** 2 or 1.0

    def _blurred(self, stack: Matrix) -> Matrix:
        return fir.blur(stack, fir.gaussian_taps(self.sigma), stack.ndim - 1)


class Windows(NamedTuple):
    """The grid's samples and the moments of the window around each."""

    fixed: Volume  # about the mean of the image, 0 where the weight is
    moving: Volume
    weight: Volume  # at most 1
    per_mass: Volume  # one by the weight of the window
    fixed_mean: Volume
    moving_mean: Volume
    correlation: Volume
    scale: Volume  # one by the root of both variances
    moving_power: Volume  # variance and floor
