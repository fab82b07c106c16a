"""Correlation of the directions in which two images change."""

import math
from dataclasses import dataclass
from typing import ClassVar, Literal, NamedTuple, Self, final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from regframe.kernels import carried, channel_correlation, fourier, orientation
from regframe.kernels.channel_correlation import Moments
from regframe.kernels.fourier import BLOCK, Spectrum
from regframe.kernels.orientation import Features, Settings
from regframe.kernels.scratch import New, fresh, scratch
from regframe.metrics.base import Metric, Pairs, Translations, Turned
from regframe.types import Matrix, Scores, Values, Volume


@final
class OrientedGradients(Metric):
    """Minus the correlation of channels of unsigned gradient directions, in [-1, 1].

    After Ye, Bruzzone, Shan, Bovolo and Zhu, "Fast and robust matching for multimodal remote sensing image
    registration", IEEE Trans. Geoscience and Remote Sensing 57(11), 2019: edges count by place and
    direction, whichever side is brighter. Gradients are smoothed as channels (so that opposite signs add),
    divided by their length plus a share of what is usual in the image, and correlated with weights.
    Departures: the channels |g . e_k| of the paper are kept as what they amount to, a length and a tensor,
    three numbers a point in 2-D and six in 3-D. Weightless samples are left out of all smoothing. Without
    any edge in common weight the value is 0, without weight infinite.
    """

    inner: float = Field(1.0, gt=0, le=32, description="Gaussian of the intensities, in grid points.")
    outer: float = Field(1.5, gt=0, le=32, description="Gaussian of the channels, in grid points.")
    offset: float = Field(
        0.3,
        gt=0,
        le=100,
        description="Share of the image's mean strength of gradients below which an edge counts less.",
    )
    magnitude: float = Field(
        1.5, ge=0, le=100, description="Weight of the gradient's length beside its direction."
    )

    layout: ClassVar[Literal["points", "grid"]] = "grid"
    suits: ClassVar[tuple[str, ...]] = ("mono", "inverted", "multimodal")
    invariant_to: ClassVar[tuple[str, ...]] = ("shift", "scale", "inversion")
    unrelated: ClassVar[float | None] = 0.0

    def value(self, pairs: Pairs) -> float:
        """Minus the weighted correlation over all channels about their means."""
        return _value(channel_correlation.moments(*self._both(pairs)))

    def derivative(self, pairs: Pairs) -> Values:
        """Slope of the value by each moving intensity."""
        return self.value_and_derivative(pairs)[1]

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Values]:
        """The value, and its slope by each moving intensity.

        With f and m the channels about their weighted means, and sums over channels and points, by a
        channel: d value / d m = w (a m - f) / sqrt(sum w f f  sum w m m), a = sum w f m / sum w m m. From
        there `orientation.back` walks to the intensities.
        """
        fixed, moving, weight = self._both(pairs)
        met = channel_correlation.moments(fixed, moving, weight)
        value = _value(met)
        if not np.isfinite(value) or not _varies(met):
            return value, np.zeros_like(pairs.moving)
        forces = channel_correlation.channel_forces(fixed, moving, weight, met, _factors(met))
        slopes = orientation.back(forces, moving, weight, self._settings(pairs.moving_range))
        return value, slopes.ravel()

    def prepare(self, pairs: Pairs) -> object:
        """Channels of the fixed image."""
        return self._features(pairs.fixed, pairs, pairs.fixed_range)

    def translations(self, pairs: Pairs, lattice: tuple[int, ...]) -> Translations:
        """Correlations at all translations: channels about their means over the whole image, by FFT."""
        planes = (1,) * (3 - len(lattice)) + tuple(lattice)
        made = self._fixed(pairs)
        found = channel_correlation.planes(made, pairs.weight.reshape(made.trust.shape))
        return ChannelTranslations(lattice, Transformed.of(found, planes), self._settings(pairs.moving_range))

    def carried(self, pairs: Pairs, moving: Volume, weight: Volume) -> "CarriedChannels | None":
        """Both images' channels; those of the moving one are carried along by maps."""
        if moving.ndim != 2:
            return None
        fixed = self._fixed(pairs)
        return CarriedChannels(
            carried.interleaved(fixed, pairs.weight.reshape(fixed.trust.shape)),
            carried.interleaved(*_made(moving, weight, self._settings(pairs.moving_range))),
        )

    def _both(self, pairs: Pairs) -> tuple[Features, Features, Volume]:
        moving = self._features(pairs.moving, pairs, pairs.moving_range, scratch)
        return self._fixed(pairs), moving, pairs.weight.reshape(moving.trust.shape)

    def _fixed(self, pairs: Pairs) -> Features:
        """Those prepared, or made now."""
        if isinstance(pairs.prepared, Features):
            return pairs.prepared
        return self._features(pairs.fixed, pairs, pairs.fixed_range)

    def _features(
        self, values: Values, pairs: Pairs, span: tuple[float, float], new: New = fresh
    ) -> Features:
        shape, settings = _planes(pairs), self._settings(span)
        return orientation.features(values.reshape(shape), pairs.weight.reshape(shape), settings, new)

    def _settings(self, span: tuple[float, float]) -> Settings:
        flat = FLAT * (span[1] - span[0]) + ROUNDING * max(abs(span[0]), abs(span[1])) + TINY
        return Settings(self.inner, self.outer, self.offset, self.magnitude, flat)


class Transformed(NamedTuple):
    """Spectra of what `channel_correlation.planes` gives."""

    channels: Spectrum
    coarse: Spectrum  # of mass and power, which vary slowly with the translation

    @classmethod
    def of(cls, found: NDArray[np.float32], lattice: tuple[int, ...]) -> Self:
        """Zeros added up to a lattice of translations."""
        return cls(
            fourier.spectra(found[2:], lattice), fourier.spectra(fourier.shortened(found[:2]), _few(lattice))
        )


@dataclass(frozen=True, slots=True)
class ChannelTranslations:
    """Minus the correlation at all translations, the channels about their means over the whole image."""

    lattice: tuple[int, ...]
    fixed: Transformed
    settings: Settings

    def __call__(self, moving: Volume, weight: Volume) -> tuple[Scores, Scores]:
        """Values and shared weights of a moving image, its channels made here."""
        return self._scored(channel_correlation.planes(*_made(moving, weight, self.settings)))

    def upright(self, moving: Volume, weight: Volume) -> Turned:
        """The same of a moving image that is turned, its channels made once."""
        channels = carried.about_means(carried.interleaved(*_made(moving, weight, self.settings)))

        def score(index_map: Matrix, shape: tuple[int, int], angle_rad: float) -> tuple[Scores, Scores]:
            return self._scored(carried.turned(channels, index_map, shape, angle_rad))

        return score

    def _scored(self, found: NDArray[np.float32]) -> tuple[Scores, Scores]:
        planes = (1,) * (3 - len(self.lattice)) + tuple(self.lattice)
        moving, fixed, few = Transformed.of(found, planes), self.fixed, _few(planes)
        both = fourier.correlate(fixed.channels, moving.channels, planes)
        # Mass and mass, mass and power, power and mass; power stands behind mass.
        sums = [
            fourier.correlate(fixed.coarse[i, None], moving.coarse[j, None], few)
            for i, j in ((0, 0), (0, 1), (1, 0))
        ]
        shared, *powers = (BLOCK * BLOCK * np.maximum(one, 0.0) for one in sums)
        power = powers[0] * powers[1]
        floor = FAINT * float(power.max()) + TINY
        per = fourier.lengthened(1.0 / np.sqrt(np.maximum(power, floor)))
        values = np.asarray(-both * per, np.float32).reshape(self.lattice)
        return values, fourier.lengthened(shared).reshape(self.lattice)


def _made(moving: Volume, weight: Volume, settings: Settings) -> tuple[Features, Volume]:
    """Channels of a moving image, scratch, and its weights as planes."""
    planes = (1,) * (3 - weight.ndim) + weight.shape
    weight = weight.reshape(planes)
    return orientation.features(moving.reshape(planes), weight, settings, scratch), weight


def _few(lattice: tuple[int, ...]) -> tuple[int, ...]:
    """Every `BLOCK`-th translation along y and x."""
    return (*lattice[:-2], lattice[-2] // BLOCK, lattice[-1] // BLOCK)


@dataclass(frozen=True, slots=True)
class CarriedChannels:
    """Channels and what their points weigh, (ny, nx, 4) float32 each; see `Metric.carried`.

    Steps are short, so that channels turn little and are carried as they are.
    """

    fixed: Volume
    moving: Volume

    def value(self, index_map: Matrix) -> float:
        """Minus the correlation under a map from fixed to moving indices, (2, 3), y first."""
        return _value(carried.moments(self.fixed, self.moving, index_map))

    def value_and_slope(self, index_map: Matrix) -> tuple[float, Matrix]:
        """The value, and its slope by the map, (2, 3)."""
        met = carried.moments(self.fixed, self.moving, index_map)
        value = _value(met)
        if not np.isfinite(value) or not _varies(met):
            return value, np.zeros((2, 3))
        return value, carried.pull(self.fixed, self.moving, index_map, met, _factors(met))


TINY = 1e-20
FAINT = 1e-2
"""Of the largest product of two overlapping images' powers: less is a corner that coarse sums miss."""
FLAT = 1e-4
"""Of the range: gradients below this have no direction."""
ROUNDING = 1e-9
"""Of the largest intensity: what smoothing may leave of a constant image."""


def _factors(met: Moments) -> tuple[float, float]:
    """Of fixed and of moving channels in the slope of the value by the latter."""
    norm = 1.0 / math.sqrt(met.fixed_power * met.moving_power)
    return -norm, met.both * norm / met.moving_power


def _varies(met: Moments) -> bool:
    return met.fixed_power * met.moving_power > TINY * met.mass * met.mass


def _value(met: Moments) -> float:
    if not met.mass:
        return float("inf")
    return -met.both / math.sqrt(met.fixed_power * met.moving_power) if _varies(met) else 0.0


def _planes(pairs: Pairs) -> tuple[int, ...]:
    shape = pairs.shape or pairs.weight.shape  # layout "grid" always has a shape
    return (1,) * (3 - len(shape)) + tuple(shape)
