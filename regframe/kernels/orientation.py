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
    offset: float  # share of the image's mean strength that is added to a channel's own before division
    magnitude: float  # weight of the length beside the direction
    flat: float  # gradients well below this have no direction, intensity a grid point


class Features(NamedTuple):
    """Channels of an image, and what the way back needs."""

    units: Volume  # (c, nz, ny, nx), of less than unit length
    trust: Volume  # (nz, ny, nx) in [0, 1]: how far a gradient rests on intensities that exist
    smooth: Volume  # (2, nz, ny, nx): 1 where an intensity exists, smoothed; intensities, smoothed
    raw: Volume  # (c + 1, nz, ny, nx): channels before division, and `trust`, smoothed
    mean: float  # strength that channels are compared with


def features(values: Volume, weight: Volume, settings: Settings) -> Features:
    """Channels of an image whose intensities exist where the weight is above 0.

    Parameters
    ----------
    values, weight : (nz, ny, nx) float64
    settings : Settings
    """
    axes, shape = _axes(weight)
    smooth = np.empty((2, *shape))
    _by_rows(_begin, values, weight, smooth)
    smooth = blur(smooth, gaussian_taps(settings.inner), axes)
    trust = np.empty(shape)
    _by_rows(_divide, weight, smooth, trust)
    raw = np.empty((4 if axes == 2 else 7, *shape))
    _by_rows(_tensors, smooth[1], trust, raw, settings.magnitude, settings.flat)
    raw = blur(raw, gaussian_taps(settings.outer), axes)
    rows = np.empty((2, shape[0] * shape[1]))
    _by_rows(_normalise, raw, trust, rows)
    mass, total = rows.sum(axis=1)
    mean = float(total / mass) if mass > 0.0 else 0.0
    units = np.empty((len(raw) - 1, *shape))
    _by_rows(_divide_channels, raw, units, settings.offset * mean + settings.flat)
    return Features(units, trust, smooth, raw, mean)


def back(forces: Volume, made: Features, weight: Volume, settings: Settings) -> Volume:
    """Slope of a number by each intensity, from its slopes by the channels.

    Parameters
    ----------
    forces : (c, nz, ny, nx) float64
        Slopes by `made.units`, at fixed weights.
    made : Features
    weight : (nz, ny, nx) float64
        What the features were made with.
    settings : Settings
    """
    axes, shape = _axes(weight)
    floor = settings.offset * made.mean + settings.flat
    rows = np.empty((2, shape[0] * shape[1]))
    _by_rows(_mean_forces, forces, made.units, made.raw, made.trust, floor, rows)
    mass, total = rows.sum(axis=1)
    by_mean = settings.offset * float(total / mass) if mass > 0.0 else 0.0
    by_raw = np.empty(forces.shape)
    _by_rows(_raw_forces, forces, made.units, made.raw, made.trust, floor, by_mean, by_raw)
    by_raw = blur(by_raw, gaussian_taps(settings.outer), axes)
    slopes = np.zeros((3, *shape))
    _by_rows(_gradient_forces, by_raw, made.smooth[1], made.trust, slopes, settings.magnitude, settings.flat)
    by_smooth = np.empty((1, *shape))
    _by_rows(_undo_differences, slopes, made.smooth, by_smooth[0])
    out = blur(by_smooth, gaussian_taps(settings.inner), axes)[0]
    _by_rows(_where_present, weight, out)
    return out


def _axes(weight: Volume) -> tuple[int, tuple[int, ...]]:
    return (2 if weight.shape[0] == 1 else 3), weight.shape


def _by_rows(function: Callable[..., object], *arguments: object) -> None:
    """Share the rows of the volumes among threads."""
    shape = next(one.shape for one in arguments if isinstance(one, np.ndarray) and one.ndim >= 3)[-3:]
    split(function, shape[0] * shape[1], shape[2] * 4, *arguments)


@kernel
def _begin(first: int, last: int, values: Volume, weight: Volume, out: Volume) -> None:
    _, ny, nx = weight.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(U(nx)):
            there = weight[z, y, x] > 0.0
            out[0, z, y, x] = 1.0 if there else 0.0
            out[1, z, y, x] = values[z, y, x] if there else 0.0


@kernel
def _divide(first: int, last: int, weight: Volume, smooth: Volume, trust: Volume) -> None:
    """Normalised convolution. A straight border has a density of a half: no gradient there is trusted."""
    _, ny, nx = weight.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(U(nx)):
            density = max(smooth[0, z, y, x], 1e-12)
            smooth[0, z, y, x] = density
            smooth[1, z, y, x] /= density
            sure = min(max(2.0 * density - 1.0, 0.0), 1.0)
            trust[z, y, x] = sure if weight[z, y, x] > 0.0 else 0.0


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
    """Channels times trust, and trust."""
    nz, ny, nx = smooth.shape
    planar, third, small = len(raw) == 4, 1.0 / math.sqrt(3.0), flat * flat
    padded = np.empty(nx + 2)
    for row in range(first, last):
        z, y = row // ny, row % ny
        padded[1:-1] = smooth[z, y]
        padded[0], padded[-1] = padded[1], padded[-2]
        up, down = smooth[z, max(y - 1, 0)], smooth[z, min(y + 1, ny - 1)]
        front, behind = smooth[max(z - 1, 0), y], smooth[min(z + 1, nz - 1), y]
        t, c0, c1, c2, last_channel = trust[z, y], raw[0, z, y], raw[1, z, y], raw[2, z, y], raw[-1, z, y]
        for x in range(U(nx)):
            gx, gy, gz = padded[x + U(2)] - padded[x], down[x] - up[x], behind[x] - front[x]
            length = math.sqrt(0.25 * (gx * gx + gy * gy + gz * gz) + small)
            per = 0.25 * t[x] / length
            last_channel[x] = t[x]
            c0[x] = magnitude * t[x] * (length - flat)
            c1[x] = per * (gx * gx - gy * gy)
            c2[x] = per * 2.0 * gx * gy
        if planar:
            continue
        c3, c4, c5 = raw[3, z, y], raw[4, z, y], raw[5, z, y]
        for x in range(U(nx)):
            gx, gy, gz = padded[x + U(2)] - padded[x], down[x] - up[x], behind[x] - front[x]
            square = gx * gx + gy * gy + gz * gz
            per = 0.25 * t[x] / math.sqrt(0.25 * square + small)
            c3[x] = per * 2.0 * gx * gz
            c4[x] = per * 2.0 * gy * gz
            c5[x] = per * (3.0 * gz * gz - square) * third


@kernel
def _normalise(first: int, last: int, raw: Volume, trust: Volume, rows: Volume) -> None:
    """Divide channels by the smoothed trust, in place; sums of trust, and trust times their length."""
    count, _, ny, nx = raw.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        mass, total = 0.0, 0.0
        for x in range(U(nx)):
            per, square = 1.0 / max(raw[count - 1, z, y, x], 1e-12), 0.0
            raw[count - 1, z, y, x] = per
            for c in range(count - 1):
                raw[c, z, y, x] *= per
                square += raw[c, z, y, x] * raw[c, z, y, x]
            mass += trust[z, y, x]
            total += trust[z, y, x] * math.sqrt(square)
        rows[0, row], rows[1, row] = mass, total


@kernel
def _length(raw: Volume, z: int, y: int, x: int) -> float:
    square = 1e-40
    for c in range(len(raw) - 1):
        square += raw[c, z, y, x] * raw[c, z, y, x]
    return math.sqrt(square)


@kernel
def _divide_channels(first: int, last: int, raw: Volume, units: Volume, floor: float) -> None:
    count, _, ny, nx = units.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(U(nx)):
            per = 1.0 / (_length(raw, z, y, x) + floor)
            for c in range(count):
                units[c, z, y, x] = raw[c, z, y, x] * per


@kernel
def _mean_forces(
    first: int,
    last: int,
    forces: Volume,
    units: Volume,
    raw: Volume,
    trust: Volume,
    floor: float,
    rows: Volume,
) -> None:
    """Sums of trust, and of the slopes by the divisor of every point."""
    count, _, ny, nx = units.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        mass, total = 0.0, 0.0
        for x in range(U(nx)):
            along = 0.0
            for c in range(count):
                along -= forces[c, z, y, x] * units[c, z, y, x]
            mass += trust[z, y, x]
            total += along / (_length(raw, z, y, x) + floor)
        rows[0, row], rows[1, row] = mass, total


@kernel
def _raw_forces(
    first: int,
    last: int,
    forces: Volume,
    units: Volume,
    raw: Volume,
    trust: Volume,
    floor: float,
    by_mean: float,
    out: Volume,
) -> None:
    """Slopes by the channels before the division by smoothed trust."""
    count, _, ny, nx = units.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(U(nx)):
            length = _length(raw, z, y, x)
            per = 1.0 / (length + floor)
            along = 0.0
            for c in range(count):
                along -= forces[c, z, y, x] * units[c, z, y, x]
            along = (along * per + by_mean * trust[z, y, x]) / length
            spread = raw[count, z, y, x]
            for c in range(count):
                out[c, z, y, x] = (forces[c, z, y, x] * per + along * raw[c, z, y, x]) * spread


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
def _undo_differences(first: int, last: int, slopes: Volume, smooth: Volume, out: Volume) -> None:
    """The adjoint of `_rise`, divided by the density."""
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
            out[z, y, x] = 0.5 * total / smooth[0, z, y, x]


@kernel
def _where_present(first: int, last: int, weight: Volume, out: Volume) -> None:
    _, ny, nx = weight.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(U(nx)):
            if not weight[z, y, x] > 0.0:
                out[z, y, x] = 0.0
