"""Self-similarity of neighbourhoods."""

from itertools import combinations
from typing import ClassVar, Literal, NamedTuple, final

import numpy as np
from pydantic import Field

from regframe.kernels import context, fir
from regframe.kernels.sharing import share
from regframe.metrics.base import Metric, Pairs
from regframe.types import Bins, Mask, Values, Volume


@final
class MindSsc(Metric):
    """Mean squared difference of self-similarity descriptors, in [0, 1].

    Heinrich, Jenkinson, Papiez, Brady and Schnabel, "Towards realtime multimodal fusion for image-guided
    interventions using self-similarities", MICCAI 2013: a point is described by how alike the patches around
    its neighbours are, which holds across modalities. Neighbours side by side at the distance `reach` are
    compared: 12 pairs in space, 4 in the plane. Patches are Gaussian windows. Departures: descriptors are
    numbers, not bits; the local variance that distances are compared with has a floor by the image's range,
    where the authors' program limits it to a share of its mean; weightless samples are left out of all
    patches. Without any point whose patches are known the value is infinite.
    """

    patch: float = Field(
        0.8, gt=0, le=16, description="Sigma of the patches' Gaussian window, in grid points."
    )
    reach: int = Field(2, ge=1, le=32, description="From a point to the neighbours compared, in grid points.")
    noise: float = Field(
        0.01, gt=0, le=1, description="Differences below this share of the image's range are taken for noise."
    )

    layout: ClassVar[Literal["points", "grid"]] = "grid"
    suits: ClassVar[tuple[str, ...]] = ("mono", "inverted", "multimodal")
    invariant_to: ClassVar[tuple[str, ...]] = ("shift", "scale", "inversion")

    def prepare(self, pairs: Pairs) -> "Descriptor":
        """Descriptors of the fixed image."""
        return self._described(pairs.fixed, pairs, pairs.fixed_range)

    def value(self, pairs: Pairs) -> float:
        """Weighted mean over points and channels of (exp(-df / vf) - exp(-dm / vm))^2."""
        return self._met(pairs)[0]

    def derivative(self, pairs: Pairs) -> Values:
        """Slope of the value by each moving intensity."""
        return self.value_and_derivative(pairs)[1]

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Values]:
        """The value, and its slope by each moving intensity.

        A channel holds p = exp(-d / v) with d the patch distance less the least of all channels, and v the
        mean of d over the channels, or its floor. So d p / d d = -p / v in the channel itself,
        + p d / v^2 / (number of channels) in all where v is above its floor, and what the distances of a
        point feel in sum is taken from the least of them.
        """
        value, apart, weight, moving = self._met(pairs)
        mass = float(weight.sum()) * len(apart)
        if not mass:
            return value, np.zeros_like(pairs.moving)
        felt = 2.0 * weight / mass * apart * moving.channels / moving.variance
        spread = np.sum(felt * moving.distances, axis=0) / (moving.variance * len(apart))
        slopes = np.where(moving.floored, 0.0, spread) - felt
        np.put_along_axis(
            slopes,
            moving.least[None],
            np.take_along_axis(slopes, moving.least[None], axis=0) - slopes.sum(axis=0),
            axis=0,
        )
        dim, shape, out = len(pairs.shape or ()), weight.shape, np.empty(weight.shape)
        slopes = fir.blur(_divided(slopes, moving.mass), fir.gaussian_taps(self.patch), dim)
        parts = (_volume(pairs.moving, shape), moving.weight, self._offsets(dim))
        share(context.back, shape[0] * shape[1], *parts, slopes, out)
        return value, out.ravel()

    def _met(self, pairs: Pairs) -> tuple[float, Volume, Volume, "Descriptor"]:
        """Value, differences of the channels, weight of the points, and the moving image's descriptors."""
        fixed = pairs.prepared if isinstance(pairs.prepared, Descriptor) else self.prepare(pairs)
        moving = self._described(pairs.moving, pairs, pairs.moving_range)
        known = fixed.known & moving.known
        weight = np.where(known, pairs.weight.reshape(known.shape), 0.0)
        apart = moving.channels - fixed.channels
        mass = float(weight.sum()) * len(apart)
        value = float(np.sum(weight * np.sum(apart * apart, axis=0))) / mass if mass else float("inf")
        return value, apart, weight, moving

    def _described(self, values: Values, pairs: Pairs, span: tuple[float, float]) -> "Descriptor":
        shape = pairs.shape or pairs.weight.shape  # layout "grid" always has a shape
        dim, shape = len(shape), (1,) * (3 - len(shape)) + tuple(shape)
        weight = pairs.weight / (float(pairs.weight.max()) or 1.0)
        parts = (_volume(values, shape), _volume(weight, shape), self._offsets(dim))
        squares, mass = np.empty((2, len(parts[2]), *shape))
        share(context.differ, len(squares) * shape[0] * shape[1], *parts, squares, mass)
        taps = fir.gaussian_taps(self.patch)
        distances, mass = fir.blur(squares, taps, dim), fir.blur(mass, taps, dim)
        floor = (self.noise * (span[1] - span[0])) ** 2 or 1.0
        channels, variance = np.empty_like(distances), np.empty(shape)
        least = np.empty(shape, np.int64)
        flat = (part.reshape(len(part), -1) for part in (distances, mass))
        into = (channels.reshape(len(channels), -1), variance.reshape(-1), least.reshape(-1))
        share(context.describe, least.size, *flat, floor, *into)
        known, floored = mass[0] > 0.0, variance <= floor
        return Descriptor(channels, distances, variance, floored, least, mass, known, parts[1])

    def _offsets(self, dim: int) -> Bins:
        """Both neighbours' offsets z y x, for each pair of neighbours side by side, (channels, 6)."""
        around = [
            tuple(sign * self.reach * (axis == along) for axis in range(3))
            for along in range(3 - dim, 3)
            for sign in (-1, 1)
        ]
        beside = ((*one, *other) for one, other in combinations(around, 2) if any(np.add(one, other)))
        return np.array(list(beside), np.int64)


class Descriptor(NamedTuple):
    """What every point looks like to its neighbours."""

    channels: Volume  # (channels, nz, ny, nx), 1 for the most alike
    distances: Volume  # of the patches, less the least of a point
    variance: Volume
    floored: Mask
    least: Bins  # the channel of the least distance
    mass: Volume  # of the windows, (channels, nz, ny, nx)
    known: Mask
    weight: Volume  # of the image, at most 1


def _volume(values: Values, shape: tuple[int, ...]) -> Volume:
    return np.ascontiguousarray(values.reshape(shape))


def _divided(values: Volume, by: Volume) -> Volume:
    return np.divide(values, by, out=np.zeros_like(values), where=by > 0.0)
