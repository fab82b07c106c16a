"""Weighted correlation of the channels of two images, and its slope by one of them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regframe.kernels.fir import split
from regframe.kernels.jit import kernel
from regframe.kernels.orientation import Features
from regframe.kernels.scratch import scratch
from regframe.kernels.sharing import BLOCKS, share
from regframe.types import Matrix, Values, Volume

U = np.uint64


class Moments(NamedTuple):
    """Weighted sums over the channels of two images."""

    mass: float
    fixed: Values  # (c,) means
    moving: Values
    both: float  # sums of products about the means
    fixed_power: float
    moving_power: float


def moments(fixed: Features, moving: Features, weight: Volume) -> Moments:
    """Sums over the points that both trust, times weight."""
    count = len(fixed.units)
    partial = np.zeros((BLOCKS, 3 * count + 3))
    arguments = (fixed.units, fixed.trust, moving.units, moving.trust, weight, partial)
    share(_sum_products, BLOCKS, *arguments)
    sums = partial.sum(axis=0)
    mass = float(sums[0])
    if not mass:
        return Moments(0.0, np.zeros(count), np.zeros(count), 0.0, 0.0, 0.0)
    below, above = sums[1 : 1 + count] / mass, sums[1 + count : 1 + 2 * count] / mass
    both, fixed_power, moving_power = sums[1 + 2 * count : 4 + 2 * count]
    return Moments(
        mass,
        below,
        above,
        float(both - mass * np.sum(below * above)),
        float(fixed_power - mass * np.sum(below * below)),
        float(moving_power - mass * np.sum(above * above)),
    )


def channel_forces(
    fixed: Features, moving: Features, weight: Volume, met: Moments, factors: tuple[float, float]
) -> Volume:
    """Weight times (factor of fixed times fixed channels + that of moving times moving), about the means.

    The array is scratch: it holds until this thread asks again.
    """
    out = scratch("forces", moving.units.shape)
    means = factors[0] * met.fixed + factors[1] * met.moving
    given = (fixed.units, fixed.trust, moving.units, moving.trust, weight, means, np.array(factors), out)
    nz, ny, nx = weight.shape
    split(_mix, nz * ny, 4 * nx, *given)
    return out


def planes(made: Features, weight: Volume) -> NDArray[np.float32]:
    """What is correlated to compare images at all translations, (c + 2, nz, ny, nx).

    Weight times trust; that times the squared length of the channels about their means; and times each of
    them.
    """
    count, nz, ny, nx = made.units.shape
    partial, out = np.zeros((BLOCKS, 1 + count)), np.empty((count + 2, nz, ny, nx), np.float32)
    share(_sum_channels, BLOCKS, made.units, made.trust, weight, partial)
    sums = partial.sum(axis=0)
    means = sums[1:] / (float(sums[0]) or 1.0)
    split(_centre, nz * ny, 4 * nx, made.units, made.trust, weight, means, out)
    return out


@kernel
def _weigh(weight: Values, fixed: Values, moving: Values, out: Values) -> None:
    for x in range(U(len(out))):
        out[x] = weight[x] * fixed[x] * moving[x]


@kernel
def _sum_products(
    first: int,
    last: int,
    fixed: Volume,
    fixed_trust: Volume,
    moving: Volume,
    moving_trust: Volume,
    weight: Volume,
    partial: Matrix,
) -> None:
    """Per block: mass, sums of fixed and of moving channels, of their products and of their squares."""
    count, nz, ny, nx = fixed.shape
    w = np.empty(nx)
    for block in range(first, last):
        sums = partial[block]
        for row in range(nz * ny * block // len(partial), nz * ny * (block + 1) // len(partial)):
            z, y = row // ny, row % ny
            _weigh(weight[z, y], fixed_trust[z, y], moving_trust[z, y], w)
            mass = 0.0
            for x in range(U(nx)):
                mass += w[x]
            sums[0] += mass
            if mass == 0.0:
                continue
            for c in range(count):
                one, other = fixed[c, z, y], moving[c, z, y]
                below = above = both = below_power = above_power = 0.0
                for x in range(U(nx)):
                    a, b = w[x] * one[x], w[x] * other[x]
                    below, above = below + a, above + b
                    both += a * other[x]
                    below_power += a * one[x]
                    above_power += b * other[x]
                sums[1 + c] += below
                sums[1 + count + c] += above
                sums[1 + 2 * count] += both
                sums[2 + 2 * count] += below_power
                sums[3 + 2 * count] += above_power


@kernel
def _mix(
    first: int,
    last: int,
    fixed: Volume,
    fixed_trust: Volume,
    moving: Volume,
    moving_trust: Volume,
    weight: Volume,
    means: Values,
    factors: Values,
    out: Volume,
) -> None:
    count, _, ny, nx = fixed.shape
    by_fixed, by_moving, w = factors[0], factors[1], np.empty(nx)
    for row in range(first, last):
        z, y = row // ny, row % ny
        _weigh(weight[z, y], fixed_trust[z, y], moving_trust[z, y], w)
        for c in range(count):
            one, other, force, mean = fixed[c, z, y], moving[c, z, y], out[c, z, y], means[c]
            for x in range(U(nx)):
                force[x] = w[x] * ((by_fixed * one[x] + by_moving * other[x]) - mean)


@kernel
def _sum_channels(
    first: int, last: int, units: Volume, trust: Volume, weight: Volume, partial: Matrix
) -> None:
    """Per block: mass, and sums of the channels."""
    count, nz, ny, nx = units.shape
    for block in range(first, last):
        for row in range(nz * ny * block // len(partial), nz * ny * (block + 1) // len(partial)):
            z, y = row // ny, row % ny
            t, w = trust[z, y], weight[z, y]
            mass = 0.0
            for x in range(U(nx)):
                mass += t[x] * w[x]
            partial[block, 0] += mass
            for c in range(count):
                one, total = units[c, z, y], 0.0
                for x in range(U(nx)):
                    total += t[x] * w[x] * one[x]
                partial[block, 1 + c] += total


@kernel
def _centre(
    first: int, last: int, units: Volume, trust: Volume, weight: Volume, means: Values, out: Volume
) -> None:
    count, _, ny, nx = units.shape
    mass, power = np.empty(nx), np.empty(nx)
    for row in range(first, last):
        z, y = row // ny, row % ny
        t, w, out_mass, out_power = trust[z, y], weight[z, y], out[0, z, y], out[1, z, y]
        for x in range(U(nx)):
            mass[x] = t[x] * w[x]
            power[x] = 0.0
            out_mass[x] = mass[x]
        for c in range(count):
            one, line, mean = units[c, z, y], out[2 + c, z, y], means[c]
            for x in range(U(nx)):
                about = one[x] - mean
                power[x] += about * about
                line[x] = mass[x] * about
        for x in range(U(nx)):
            out_power[x] = mass[x] * power[x]
