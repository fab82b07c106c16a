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
from regframe.kernels.scratch import New, fresh, scratch
from regframe.types import Matrix, Values, Volume

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
    smooth: Volume  # (2, nz, ny, nx): 1 / (1 where an intensity exists, smoothed); intensities, smoothed
    length: Volume  # (nz, ny, nx): of the channels before division
    spread: Volume  # (nz, ny, nx): 1 / trust, smoothed
    floor: float  # what lengths were added to before division by them


def features(values: Volume, weight: Volume, settings: Settings, new: New = fresh) -> Features:
    """Channels of an image whose intensities exist where the weight is above 0.

    Parameters
    ----------
    values, weight : (nz, ny, nx) float64
    settings : Settings
    new : callable
        Where arrays come from; with `scratch` the channels hold until the thread makes the next.
    """
    axes, shape = _axes(weight)
    count = 4 if axes == 2 else 7
    sharp, smooth = scratch("sharp", (2, *shape)), new("smooth", (2, *shape))
    _by_rows(_begin, values, weight, sharp)
    smooth = blur(sharp, gaussian_taps(settings.inner), axes, smooth)
    trust = new("trust", shape)
    _by_rows(_divide, weight, smooth, trust)
    tensors = scratch("tensors", (count, *shape))
    _by_rows(_tensors, smooth[1], trust, tensors, settings.magnitude, settings.flat)
    raw = blur(tensors, gaussian_taps(settings.outer), axes, new("raw", (count, *shape)))
    length, rows = new("length", shape), np.empty((2, shape[0] * shape[1]))
    _by_rows(_normalise, raw, trust, length, rows)
    mass, total = rows.sum(axis=1)
    floor = (settings.offset * float(total / mass) if mass > 0.0 else 0.0) + settings.flat
    _by_rows(_shorten, raw, length, floor)
    return Features(raw[:-1], trust, smooth, length, raw[-1], floor)


def back(forces: Volume, made: Features, weight: Volume, settings: Settings) -> Volume:
    """Slope of a number by each intensity, from its slopes by the channels.

    Parameters
    ----------
    forces : (c, nz, ny, nx) float64
        Slopes by `made.units`, at fixed weights. Changed.
    made : Features
    weight : (nz, ny, nx) float64
        What the features were made with.
    settings : Settings
    """
    axes, shape = _axes(weight)
    rows = np.empty((2, shape[0] * shape[1]))
    _by_rows(_mean_forces, forces, made.units, made.length, made.trust, made.floor, rows)
    mass, total = rows.sum(axis=1)
    by_mean = settings.offset * float(total / mass) if mass > 0.0 else 0.0
    _by_rows(_raw_forces, forces, made.units, made.length, made.trust, made.spread, made.floor, by_mean)
    by_raw = blur(forces, gaussian_taps(settings.outer), axes, scratch("by_raw", forces.shape))
    slopes = scratch("slopes", (axes, *shape))
    pull = _forces_in_plane if axes == 2 else _forces_in_space
    _by_rows(pull, by_raw, made.smooth[1], made.trust, slopes, settings.magnitude, settings.flat)
    by_smooth = scratch("by_smooth", (1, *shape))
    _by_rows(_undo_differences, slopes, made.smooth[0], by_smooth[0])
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
        value, w, there, kept = values[z, y], weight[z, y], out[0, z, y], out[1, z, y]
        for x in range(U(nx)):
            there[x] = 1.0 if w[x] > 0.0 else 0.0
            kept[x] = value[x] if w[x] > 0.0 else 0.0


@kernel
def _divide(first: int, last: int, weight: Volume, smooth: Volume, trust: Volume) -> None:
    """Normalised convolution. A straight border has a density of a half: no gradient there is trusted."""
    _, ny, nx = weight.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        w, t, density, value = weight[z, y], trust[z, y], smooth[0, z, y], smooth[1, z, y]
        for x in range(U(nx)):
            found = max(density[x], 1e-12)
            sure = min(max(2.0 * found - 1.0, 0.0), 1.0)
            per = 1.0 / found
            t[x] = sure if w[x] > 0.0 else 0.0
            density[x] = per
            value[x] *= per


@kernel
def _pad(row: Values, padded: Values) -> None:
    """A row with its ends twice."""
    for x in range(U(len(row))):
        padded[x + U(1)] = row[x]
    padded[0], padded[-1] = row[0], row[-1]


@kernel
def _tensors(
    first: int, last: int, smooth: Volume, trust: Volume, raw: Volume, magnitude: float, flat: float
) -> None:
    """Channels times trust, and trust. Central differences; half of one step at the border."""
    nz, ny, nx = smooth.shape
    planar, third, small = len(raw) == 4, 1.0 / math.sqrt(3.0), flat * flat
    padded = np.empty(nx + 2)
    for row in range(first, last):
        z, y = row // ny, row % ny
        _pad(smooth[z, y], padded)
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
def _normalise(first: int, last: int, raw: Volume, trust: Volume, length: Volume, rows: Matrix) -> None:
    """Divide channels by the smoothed trust, in place; sums of trust, and trust times their length."""
    count, _, ny, nx = raw.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        t, long, spread = trust[z, y], length[z, y], raw[count - 1, z, y]
        for x in range(U(nx)):
            spread[x] = 1.0 / max(spread[x], 1e-12)
            long[x] = 1e-40
        for c in range(count - 1):
            channel = raw[c, z, y]
            for x in range(U(nx)):
                one = channel[x] * spread[x]
                channel[x] = one
                long[x] += one * one
        for x in range(U(nx)):
            long[x] = math.sqrt(long[x])
        mass, total = 0.0, 0.0
        for x in range(U(nx)):
            mass += t[x]
            total += t[x] * long[x]
        rows[0, row], rows[1, row] = mass, total


@kernel
def _shorten(first: int, last: int, raw: Volume, length: Volume, floor: float) -> None:
    """Divide channels by their length and `floor`, in place."""
    count, _, ny, nx = raw.shape
    per = np.empty(nx)
    for row in range(first, last):
        z, y = row // ny, row % ny
        long = length[z, y]
        for x in range(U(nx)):
            per[x] = 1.0 / (long[x] + floor)
        for c in range(count - 1):
            channel = raw[c, z, y]
            for x in range(U(nx)):
                channel[x] *= per[x]


@kernel
def _along(forces: Volume, units: Volume, z: int, y: int, long: Values, floor: float, out: Values) -> None:
    """Of a row: slopes by the divisor."""
    out[:] = 0.0
    for c in range(len(forces)):
        force, unit = forces[c, z, y], units[c, z, y]
        for x in range(U(len(out))):
            out[x] -= force[x] * unit[x]
    for x in range(U(len(out))):
        out[x] /= long[x] + floor


@kernel
def _mean_forces(
    first: int,
    last: int,
    forces: Volume,
    units: Volume,
    length: Volume,
    trust: Volume,
    floor: float,
    rows: Matrix,
) -> None:
    """Sums of trust, and of the slopes by the divisor of every point."""
    _, _, ny, nx = units.shape
    along = np.empty(nx)
    for row in range(first, last):
        z, y = row // ny, row % ny
        t = trust[z, y]
        _along(forces, units, z, y, length[z, y], floor, along)
        mass, total = 0.0, 0.0
        for x in range(U(nx)):
            mass += t[x]
            total += along[x]
        rows[0, row], rows[1, row] = mass, total


@kernel
def _raw_forces(
    first: int,
    last: int,
    forces: Volume,
    units: Volume,
    length: Volume,
    trust: Volume,
    spread: Volume,
    floor: float,
    by_mean: float,
) -> None:
    """Slopes by the channels before the division by smoothed trust, in place of the forces."""
    count, _, ny, nx = units.shape
    along, per = np.empty(nx), np.empty(nx)
    for row in range(first, last):
        z, y = row // ny, row % ny
        t, long, wide = trust[z, y], length[z, y], spread[z, y]
        _along(forces, units, z, y, long, floor, along)
        for x in range(U(nx)):
            whole = long[x] + floor
            # The channel before division is its unit times the divisor.
            along[x] = (along[x] + by_mean * t[x]) * wide[x] * whole / long[x]
            per[x] = wide[x] / whole
        for c in range(count):
            force, unit = forces[c, z, y], units[c, z, y]
            for x in range(U(nx)):
                force[x] = force[x] * per[x] + along[x] * unit[x]


@kernel
def _forces_in_plane(
    first: int,
    last: int,
    forces: Volume,
    smooth: Volume,
    trust: Volume,
    out: Volume,
    magnitude: float,
    flat: float,
) -> None:
    """Slopes by the gradient's components, x and y."""
    _, ny, nx = smooth.shape
    small, padded = flat * flat, np.empty(nx + 2)
    for row in range(first, last):
        z, y = row // ny, row % ny
        _pad(smooth[z, y], padded)
        up, down = smooth[z, max(y - 1, 0)], smooth[z, min(y + 1, ny - 1)]
        t, f0, f1, f2 = trust[z, y], forces[0, z, y], forces[1, z, y], forces[2, z, y]
        out_x, out_y = out[0, z, y], out[1, z, y]
        for x in range(U(nx)):
            gx, gy = 0.5 * (padded[x + U(2)] - padded[x]), 0.5 * (down[x] - up[x])
            inverse = 1.0 / (gx * gx + gy * gy + small)
            per = t[x] * math.sqrt(inverse)
            total = f1[x] * (gx * gx - gy * gy) + f2[x] * 2.0 * gx * gy
            along = magnitude * f0[x] - total * inverse
            out_x[x] = per * (2.0 * (f1[x] * gx + f2[x] * gy) + along * gx)
            out_y[x] = per * (2.0 * (f2[x] * gx - f1[x] * gy) + along * gy)


@kernel
def _forces_in_space(
    first: int,
    last: int,
    forces: Volume,
    smooth: Volume,
    trust: Volume,
    out: Volume,
    magnitude: float,
    flat: float,
) -> None:
    """Slopes by the gradient's components, x, y and z."""
    nz, ny, nx = smooth.shape
    third, small, padded = 1.0 / math.sqrt(3.0), flat * flat, np.empty(nx + 2)
    for row in range(first, last):
        z, y = row // ny, row % ny
        _pad(smooth[z, y], padded)
        up, down = smooth[z, max(y - 1, 0)], smooth[z, min(y + 1, ny - 1)]
        front, behind = smooth[max(z - 1, 0), y], smooth[min(z + 1, nz - 1), y]
        t, out_x, out_y, out_z = trust[z, y], out[0, z, y], out[1, z, y], out[2, z, y]
        f0, f1, f2 = forces[0, z, y], forces[1, z, y], forces[2, z, y]
        f3, f4, f5 = forces[3, z, y], forces[4, z, y], forces[5, z, y]
        for x in range(U(nx)):
            gx, gy = 0.5 * (padded[x + U(2)] - padded[x]), 0.5 * (down[x] - up[x])
            gz, f = 0.5 * (behind[x] - front[x]), third * f5[x]
            square = gx * gx + gy * gy + gz * gz
            inverse = 1.0 / (square + small)
            per = t[x] * math.sqrt(inverse)
            total = f1[x] * (gx * gx - gy * gy) + f2[x] * 2.0 * gx * gy
            total += 2.0 * gz * (f3[x] * gx + f4[x] * gy) + f * (3.0 * gz * gz - square)
            along = magnitude * f0[x] - total * inverse
            out_x[x] = per * (2.0 * (f1[x] * gx + f2[x] * gy + f3[x] * gz - f * gx) + along * gx)
            out_y[x] = per * (2.0 * (f2[x] * gx - f1[x] * gy + f4[x] * gz - f * gy) + along * gy)
            out_z[x] = per * (2.0 * (f3[x] * gx + f4[x] * gy + 2.0 * f * gz) + along * gz)


@kernel
def _undo_differences(first: int, last: int, slopes: Volume, per: Volume, out: Volume) -> None:
    """The adjoint of the central differences, times `per`."""
    nz, ny, nx = out.shape
    padded = np.empty(nx + 2)
    for row in range(first, last):
        z, y = row // ny, row % ny
        line, share = out[z, y], per[z, y]
        _pad(slopes[0, z, y], padded)
        # Beyond the border a slope is the negative of the last one.
        padded[0], padded[-1] = -padded[0], -padded[-1]
        up, down = slopes[1, z, max(y - 1, 0)], slopes[1, z, min(y + 1, ny - 1)]
        above, below = 1.0 if y > 0 else -1.0, 1.0 if y < ny - 1 else -1.0
        for x in range(U(nx)):
            line[x] = (padded[x] - padded[x + U(2)]) + (above * up[x] - below * down[x])
        if len(slopes) == 3:
            front, behind = slopes[2, max(z - 1, 0), y], slopes[2, min(z + 1, nz - 1), y]
            above, below = 1.0 if z > 0 else -1.0, 1.0 if z < nz - 1 else -1.0
            for x in range(U(nx)):
                line[x] += above * front[x] - below * behind[x]
        for x in range(U(nx)):
            line[x] *= 0.5 * share[x]


@kernel
def _where_present(first: int, last: int, weight: Volume, out: Volume) -> None:
    _, ny, nx = weight.shape
    for row in range(first, last):
        z, y = row // ny, row % ny
        line, w = out[z, y], weight[z, y]
        for x in range(U(nx)):
            line[x] = line[x] if w[x] > 0.0 else 0.0
