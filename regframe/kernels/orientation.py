"""Oriented gradients: how strongly and which way intensities change, whatever the sign; and the way back.

A gradient g becomes channels: its length |g|, and its direction without sign as the traceless tensor
g g^T / |g|, which in 2-D is |g| (cos 2a, sin 2a). That is what any number of channels |g . e_k| hold but
for a hundredth (the next term of the Fourier series of |cos|), in 3 channels in place of 8 or more, and
in 3-D in 6. Volumes are 3-D here: a 2-D image is one slice.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from regframe.kernels.fir import blur, gaussian_taps, split
from regframe.kernels.jit import kernel
from regframe.types import Volume

U = np.uint64
TINY = 1e-12


class Settings(NamedTuple):
    """What channels are made with; lengths in grid points."""

    inner: float  # Gaussian of the intensities
    outer: float  # Gaussian of the channels
    local: float  # Gaussian of the strength that a channel is compared with; 0: the image's mean alone
    offset: float  # share of that strength that is added to a channel's own before division
    magnitude: float  # weight of the length beside the direction
    flat: float  # gradients well below this have no direction, intensity a grid point


class Features(NamedTuple):
    """Channels of an image, and what the way back needs."""

    units: Volume  # (c, nz, ny, nx), of less than unit length
    trust: Volume  # (nz, ny, nx) in [0, 1]: how far a gradient rests on intensities that exist
    present: Volume  # 1 where an intensity exists
    density: Volume  # `present`, smoothed
    smooth: Volume  # intensities, smoothed
    spread: Volume  # `trust`, smoothed
    raw: Volume  # (c, nz, ny, nx), channels before division
    strength: Volume  # their length
    level: Volume  # what they are divided by
    around: Volume  # `trust`, widely smoothed; empty without `local`


def features(values: Volume, weight: Volume, settings: Settings) -> Features:
    """Channels of an image whose intensities exist where the weight is above 0.

    Parameters
    ----------
    values, weight : (nz, ny, nx) float64
    settings : Settings
    """
    axes = 2 if values.shape[0] == 1 else 3
    inner, outer = gaussian_taps(settings.inner), gaussian_taps(settings.outer)
    present = (weight > 0.0).astype(np.float64)
    density = blur(present, inner, axes)
    smooth = blur(np.where(present > 0.0, values, 0.0), inner, axes) / np.maximum(density, TINY)
    # A straight border of the image has a density of a half: no gradient there is to be trusted.
    trust = present * np.clip(2.0 * density - 1.0, 0.0, 1.0)
    raw = np.empty((3 if axes == 2 else 6, *values.shape))
    _by_rows(_tensors, smooth, trust, raw, settings.magnitude, settings.flat)
    spread = np.maximum(blur(trust, outer, axes), TINY)
    raw = blur(raw, outer, axes)
    strength = np.empty(values.shape)
    _by_rows(_normalise, raw, spread, strength)
    mass = max(float(trust.sum()), TINY)
    mean = float(np.sum(trust * strength)) / mass
    around, level = np.empty(0), np.full(values.shape, mean)
    if settings.local > 0.0:
        wide = gaussian_taps(settings.local)
        around = np.maximum(blur(trust, wide, axes), TINY)
        level = blur(trust * strength, wide, axes) / around + REST * mean
    level = strength + settings.offset * level + settings.flat
    return Features(raw / level, trust, present, density, smooth, spread, raw, strength, level, around)


REST = 0.15
"""Share of the whole image's mean strength in the local one, so that empty regions stay empty."""


def back(forces: Volume, made: Features, settings: Settings) -> Volume:
    """Slope of a number by each intensity, from its slopes by the channels.

    Parameters
    ----------
    forces : (c, nz, ny, nx) float64
        Slopes by `made.units`, at fixed weights.
    made : Features
    settings : Settings
    """
    axes = 2 if made.trust.shape[0] == 1 else 3
    inner, outer = gaussian_taps(settings.inner), gaussian_taps(settings.outer)
    by_level = np.empty(made.trust.shape)
    _by_rows(_level_forces, forces, made.units, made.level, by_level)
    by_strength = by_level.copy()
    mass = max(float(made.trust.sum()), TINY)
    share = settings.offset
    if settings.local > 0.0:
        wide = gaussian_taps(settings.local)
        by_strength += share * made.trust * blur(by_level / made.around, wide, axes)
        share *= REST
    by_strength += share * float(by_level.sum()) / mass * made.trust
    by_raw = np.empty(forces.shape)
    _by_rows(_raw_forces, forces, made.raw, made.level, made.strength, by_strength, made.spread, by_raw)
    by_raw = blur(by_raw, outer, axes)
    slopes = np.zeros((3, *made.trust.shape))
    _by_rows(_gradient_forces, by_raw, made.smooth, made.trust, slopes, settings.magnitude, settings.flat)
    by_smooth = np.empty(made.trust.shape)
    _by_rows(_undo_differences, slopes, by_smooth)
    return made.present * blur(by_smooth / np.maximum(made.density, TINY), inner, axes)


def _by_rows(function: Callable[..., object], *arguments: object) -> None:
    """Share the rows of the volumes among threads."""
    shape = next(one.shape for one in reversed(arguments) if isinstance(one, np.ndarray))[-3:]
    split(function, shape[0] * shape[1], shape[2] * 4, *arguments)


@kernel
def _rise(volume: Volume, z: int, y: int, x: int) -> tuple[float, float, float]:
    """Central differences, x, y, z; half of one step at the border."""
    nz, ny, nx = volume.shape
    gx = 0.5 * (volume[z, y, min(x + 1, nx - 1)] - volume[z, y, max(x - 1, 0)])
    gy = 0.5 * (volume[z, min(y + 1, ny - 1), x] - volume[z, max(y - 1, 0), x])
    gz = 0.5 * (volume[min(z + 1, nz - 1), y, x] - volume[max(z - 1, 0), y, x])
    return gx, gy, gz


@kernel
def _tensors(
    first: int, last: int, smooth: Volume, trust: Volume, raw: Volume, magnitude: float, flat: float
) -> None:
    """Channels times trust."""
    _, ny, nx = smooth.shape
    planar = len(raw) == 3
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(nx):
            gx, gy, gz = _rise(smooth, z, y, x)
            square = gx * gx + gy * gy + gz * gz
            length = math.sqrt(square + flat * flat)
            t = trust[z, y, x]
            per = t / length
            raw[0, z, y, x] = magnitude * t * (length - flat)
            raw[1, z, y, x] = per * (gx * gx - gy * gy)
            raw[2, z, y, x] = per * 2.0 * gx * gy
            if not planar:
                raw[3, z, y, x] = per * 2.0 * gx * gz
                raw[4, z, y, x] = per * 2.0 * gy * gz
                raw[5, z, y, x] = per * (3.0 * gz * gz - square) / math.sqrt(3.0)


@kernel
def _normalise(first: int, last: int, raw: Volume, spread: Volume, strength: Volume) -> None:
    """Divide channels by the smoothed trust, in place, and take their length."""
    count, _, ny, nx = raw.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(nx):
            per, square = 1.0 / spread[z, y, x], 1e-24
            for c in range(count):
                raw[c, z, y, x] *= per
                square += raw[c, z, y, x] * raw[c, z, y, x]
            strength[z, y, x] = math.sqrt(square)


@kernel
def _level_forces(first: int, last: int, forces: Volume, units: Volume, level: Volume, out: Volume) -> None:
    count, _, ny, nx = units.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(nx):
            total = 0.0
            for c in range(count):
                total -= forces[c, z, y, x] * units[c, z, y, x]
            out[z, y, x] = total / level[z, y, x]


@kernel
def _raw_forces(
    first: int,
    last: int,
    forces: Volume,
    raw: Volume,
    level: Volume,
    strength: Volume,
    by_strength: Volume,
    spread: Volume,
    out: Volume,
) -> None:
    count, _, ny, nx = raw.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(nx):
            along = by_strength[z, y, x] / strength[z, y, x]
            per = 1.0 / spread[z, y, x]
            for c in range(count):
                out[c, z, y, x] = (forces[c, z, y, x] / level[z, y, x] + along * raw[c, z, y, x]) * per


@kernel
def _gradient_forces(
    first: int,
    last: int,
    forces: Volume,
    smooth: Volume,
    trust: Volume,
    out: Volume,
    magnitude: float,
    flat: float,
) -> None:
    """Slopes by the gradient's components, x, y, z."""
    _, ny, nx = smooth.shape
    planar = len(forces) == 3
    third = math.sqrt(3.0)
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(nx):
            t = trust[z, y, x]
            if t == 0.0:
                continue
            gx, gy, gz = _rise(smooth, z, y, x)
            square = gx * gx + gy * gy + gz * gz
            length = math.sqrt(square + flat * flat)
            per = t / length
            f1, f2 = forces[1, z, y, x], forces[2, z, y, x]
            dx, dy, dz = 2.0 * (f1 * gx + f2 * gy), 2.0 * (f2 * gx - f1 * gy), 0.0
            total = f1 * (gx * gx - gy * gy) + f2 * 2.0 * gx * gy
            if not planar:
                f3, f4, f5 = forces[3, z, y, x], forces[4, z, y, x], forces[5, z, y, x]
                dx += 2.0 * f3 * gz - 2.0 * f5 * gx / third
                dy += 2.0 * f4 * gz - 2.0 * f5 * gy / third
                dz = 2.0 * f3 * gx + 2.0 * f4 * gy + 4.0 * f5 * gz / third
                total += 2.0 * gz * (f3 * gx + f4 * gy) + f5 * (3.0 * gz * gz - square) / third
            along = magnitude * forces[0, z, y, x] - total / (length * length)
            out[0, z, y, x] = per * (dx + along * gx)
            out[1, z, y, x] = per * (dy + along * gy)
            out[2, z, y, x] = per * (dz + along * gz)


@kernel
def _undo_differences(first: int, last: int, slopes: Volume, out: Volume) -> None:
    """The adjoint of `_rise`."""
    _, nz, ny, nx = slopes.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(nx):
            total = slopes[0, z, y, x - 1] if x > 0 else -slopes[0, z, y, x]
            total -= slopes[0, z, y, x + 1] if x < nx - 1 else -slopes[0, z, y, x]
            total += slopes[1, z, y - 1, x] if y > 0 else -slopes[1, z, y, x]
            total -= slopes[1, z, y + 1, x] if y < ny - 1 else -slopes[1, z, y, x]
            if nz > 1:
                total += slopes[2, z - 1, y, x] if z > 0 else -slopes[2, z, y, x]
                total -= slopes[2, z + 1, y, x] if z < nz - 1 else -slopes[2, z, y, x]
            out[z, y, x] = 0.5 * total
