"""Weighted correlation of channels that are carried along by an affine map in place of being made anew."""

import math

import numpy as np
from numpy.typing import NDArray

from regframe.kernels.channel_correlation import Moments
from regframe.kernels.fir import split
from regframe.kernels.jit import blend_channels, kernel, meet_channels, pull_channels
from regframe.kernels.orientation import Features
from regframe.kernels.sharing import BLOCKS, share
from regframe.types import Matrix, Values, Volume

U = np.uint64
CHANNELS = 3
WHOLE = 2.0**32
"""Units of a point that places are counted in where they go along a row."""
NEAR = 2.0**-20
"""Points this near to a border, or beyond it, are not met."""
FAR = 2.0**30
"""No array reaches so far; farther places would not fit the units."""


def interleaved(made: Features, weight: Volume) -> Volume:
    """Channels of a plane and what each point weighs, side by side, (ny, nx, 4) float32."""
    out = np.empty((*weight.shape[1:], CHANNELS + 1), np.float32)
    split(_interleave, len(out), out[0].size, made.units[:, 0], made.trust[0], weight[0], out)
    return out


def moments(fixed: Volume, moving: Volume, index_map: Matrix) -> Moments:
    """Sums over the fixed points, each met by what lies at its place between the moving ones.

    Parameters
    ----------
    fixed, moving : (ny, nx, 4) float32
        See `interleaved`.
    index_map : (2, 3) float64
        From fixed to moving indices, y first; the last column is the offset.
    """
    partial = np.zeros((BLOCKS, 2 * CHANNELS + 4))
    share(_meet, BLOCKS, fixed, moving, index_map, partial)
    sums = np.empty(2 * CHANNELS + 4)
    _about_means(partial, sums)
    mass, *_, both, fixed_power, moving_power = sums.tolist()
    return Moments(mass, sums[1:4], sums[4:7], both, fixed_power, moving_power)


def pull(
    fixed: Volume, moving: Volume, index_map: Matrix, met: Moments, factors: tuple[float, float]
) -> Matrix:
    """Slope by the index map of a number whose slopes by the moving channels are as `factors` say, (2, 3).

    They are weight times (factor of fixed times fixed channels + that of moving times moving), about the
    means. Weights are held.
    """
    shares = np.zeros((3, CHANNELS + 1), np.float32)
    shares[0, :CHANNELS], shares[1, :CHANNELS] = factors
    shares[2, :CHANNELS] = factors[0] * met.fixed + factors[1] * met.moving
    partial = np.zeros((BLOCKS, 6))
    share(_pull, BLOCKS, fixed, moving, index_map, shares.ravel(), partial)
    return partial.sum(axis=0).reshape(2, 3)


def about_means(channels: Volume) -> Volume:
    """Channels less their weighted means; weights stay."""
    out, weight = channels.copy(), channels[..., CHANNELS].ravel()
    flat = out.reshape(-1, CHANNELS + 1)
    # All four columns, which lie side by side, are summed faster than three of them.
    flat[:, :CHANNELS] -= (weight @ flat)[:CHANNELS] / (float(weight.sum()) or 1.0)
    return out


def turned(
    upright: Volume, index_map: Matrix, shape: tuple[int, int], angle_rad: float
) -> NDArray[np.float32]:
    """What is correlated to compare turned channels with others at all translations, (5, 1, ny, nx) float32.

    As `channel_correlation.planes`: weights; these times the squared length of the channels; and times each
    of them.

    Parameters
    ----------
    upright : (my, mx, 4) float32
        About their means.
    index_map : (2, 3) float64
        From indices of the turned grid to upright ones, y first.
    shape : (ny, nx)
        The turned grid's.
    angle_rad : float
        By which the map turns x towards y; directions without sign turn twice as fast.
    """
    out = np.empty((CHANNELS + 2, 1, *shape), np.float32)
    twice = np.array([math.cos(2.0 * angle_rad), math.sin(2.0 * angle_rad)], np.float32)
    split(_turn, shape[0], 4 * shape[1], upright, index_map, twice, out)
    return out


@kernel
def _interleave(first: int, last: int, units: Volume, trust: Matrix, weight: Matrix, out: Volume) -> None:
    for row in range(first, last):
        a, b, c, t, w, line = units[0, row], units[1, row], units[2, row], trust[row], weight[row], out[row]
        for x in range(U(len(line))):
            line[x, 0], line[x, 1], line[x, 2], line[x, 3] = a[x], b[x], c[x], t[x] * w[x]


@kernel
def _reached(start: float, step: float, count: int, end: int) -> tuple[int, int]:
    """First and one after the last of `count` points, a step apart, that lie within [0, end), all but."""
    first, last = 0, count
    if step != 0.0:
        enters, leaves = -start / step, (end - start) / step
        if step < 0.0:
            enters, leaves = leaves, enters
        first = int(min(max(enters - 1.0, 0.0), count))
        last = int(min(max(leaves + 2.0, first), count))
    # Rounding to whole units must not lead out of the array.
    while first < last and not NEAR <= start + step * first < end - NEAR:
        first += 1
    while last > first and not NEAR <= start + step * (last - 1) < end - NEAR:
        last -= 1
    return first, last


@kernel
def _way(
    by: Matrix, row: int, count: int, shape: tuple[int, int]
) -> tuple[int, int, tuple[int, int, int, int]]:
    """Columns of a row that meet an array, the last not included, and how they go: y, x, and their steps."""
    y, x = by[0, 0] * row + by[0, 2], by[1, 0] * row + by[1, 2]
    if not abs(y) + abs(x) + abs(by[0, 1]) + abs(by[1, 1]) < FAR:  # or no number
        return 0, 0, (0, 0, 0, 0)
    first, last = _reached(y, by[0, 1], count, shape[0] - 1)
    left, right = _reached(x, by[1, 1], count, shape[1] - 1)
    first, last = max(first, left), min(last, right)
    y, x = y + by[0, 1] * first, x + by[1, 1] * first
    if not first < last:
        return 0, 0, (0, 0, 0, 0)
    return first, last, (int(y * WHOLE), int(x * WHOLE), int(by[0, 1] * WHOLE), int(by[1, 1] * WHOLE))


@kernel
def _turn(first: int, last: int, upright: Volume, by: Matrix, twice: Values, out: Volume) -> None:
    nx, flat, width = out.shape[3], upright.reshape(-1), 4 * upright.shape[1]
    cos, sin = twice[0], twice[1]
    for row in range(first, last):
        mass, power = out[0, 0, row], out[1, 0, row]
        c0, c1, c2 = out[2, 0, row], out[3, 0, row], out[4, 0, row]
        left, right, (y, x, down, along) = _way(by, row, nx, upright.shape[:2])
        for line in (mass, power, c0, c1, c2):
            line[:left] = line[right:] = np.float32(0.0)
        for at in range(U(left), U(right)):
            v0, v1, v2, w = blend_channels(flat, width, y, x)
            mass[at], power[at] = w, w * (v0 * v0 + v1 * v1 + v2 * v2)
            # Seen from a grid that is turned forth, directions are turned back.
            c0[at], c1[at], c2[at] = w * v0, w * (cos * v1 + sin * v2), w * (cos * v2 - sin * v1)
            y, x = y + down, x + along


@kernel
def _meet(first: int, last: int, fixed: Volume, moving: Volume, by: Matrix, partial: Matrix) -> None:
    """Per block: mass, sums of fixed and of moving channels, of their products and of their squares."""
    (ny, nx), width = fixed.shape[:2], 4 * moving.shape[1]
    near, far, sums = fixed.reshape(-1), moving.reshape(-1), np.empty(20, np.float32)
    for block in range(first, last):
        out = partial[block]
        for row in range(ny * block // len(partial), ny * (block + 1) // len(partial)):
            sums[:] = 0.0
            left, right, way = _way(by, row, nx, moving.shape[:2])
            meet_channels(sums, near, far, width, way, (left, right, 4 * row * nx))
            for c in range(3):
                out[1 + c] += sums[c]
                out[4 + c] += sums[4 + c]
                out[7] += sums[8 + c]
                out[8] += sums[12 + c]
                out[9] += sums[16 + c]
            out[0] += sums[3]


@kernel
def _about_means(partial: Matrix, sums: Values) -> None:
    """From sums of the blocks: mass, means, and sums of products about these."""
    sums[:] = 0.0
    for block in range(len(partial)):
        for i in range(len(sums)):
            sums[i] += partial[block, i]
    if sums[0] == 0.0:
        sums[:] = 0.0
        return
    for c in range(3):
        fixed, moving = sums[1 + c] / sums[0], sums[4 + c] / sums[0]
        sums[7] -= sums[1 + c] * moving
        sums[8] -= sums[1 + c] * fixed
        sums[9] -= sums[4 + c] * moving
        sums[1 + c], sums[4 + c] = fixed, moving


@kernel
def _pull(
    first: int,
    last: int,
    fixed: Volume,
    moving: Volume,
    by: Matrix,
    shares: Values,
    partial: Matrix,
) -> None:
    """Per block: sums of slopes by the place, y and x, times row, column and 1."""
    (ny, nx), width = fixed.shape[:2], 4 * moving.shape[1]
    near, far, sums = fixed.reshape(-1), moving.reshape(-1), np.empty(16, np.float32)
    for block in range(first, last):
        out = partial[block]
        for row in range(ny * block // len(partial), ny * (block + 1) // len(partial)):
            sums[:] = 0.0
            left, right, way = _way(by, row, nx, moving.shape[:2])
            pull_channels(sums, near, far, width, way, (left, right, 4 * row * nx), shares)
            for c in range(3):
                down, along = sums[c], sums[4 + c]
                out[0] += row * down
                out[1] += sums[8 + c]
                out[2] += down
                out[3] += row * along
                out[4] += sums[12 + c]
                out[5] += along
