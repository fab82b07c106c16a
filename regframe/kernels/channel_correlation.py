"""Weighted correlation of the channels of two images, and its slope by one of them."""

from typing import NamedTuple

import numpy as np

from regframe.kernels.fir import split
from regframe.kernels.jit import BLOCKS, kernel, share
from regframe.kernels.orientation import Features
from regframe.types import Values, Volume

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
    """Weight times (factor of fixed times fixed channels + that of moving times moving), about the means."""
    out = np.empty(moving.units.shape)
    means = factors[0] * met.fixed + factors[1] * met.moving
    given = (fixed.units, fixed.trust, moving.units, moving.trust, weight, means, np.array(factors), out)
    nz, ny, nx = weight.shape
    split(_mix, nz * ny, 4 * nx, *given)
    return out


@kernel
def _sum_products(
    first: int,
    last: int,
    fixed: Volume,
    fixed_trust: Volume,
    moving: Volume,
    moving_trust: Volume,
    weight: Volume,
    partial: Volume,
) -> None:
    """Per block: mass, sums of fixed and of moving channels, of their products and of their squares."""
    count, nz, ny, nx = fixed.shape
    for block in range(first, last):
        sums = partial[block]
        for row in range(nz * ny * block // len(partial), nz * ny * (block + 1) // len(partial)):
            z, y = row // ny, row % ny
            for x in range(U(nx)):
                w = weight[z, y, x] * fixed_trust[z, y, x] * moving_trust[z, y, x]
                if w == 0.0:
                    continue
                sums[0] += w
                for c in range(count):
                    a, b = fixed[c, z, y, x], moving[c, z, y, x]
                    sums[1 + c] += w * a
                    sums[1 + count + c] += w * b
                    sums[1 + 2 * count] += w * a * b
                    sums[2 + 2 * count] += w * a * a
                    sums[3 + 2 * count] += w * b * b


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
    by_fixed, by_moving = factors[0], factors[1]
    for row in range(first, last):
        z, y = row // ny, row % ny
        for x in range(U(nx)):
            w = weight[z, y, x] * fixed_trust[z, y, x] * moving_trust[z, y, x]
            for c in range(count):
                mixed = by_fixed * fixed[c, z, y, x] + by_moving * moving[c, z, y, x]
                out[c, z, y, x] = w * (mixed - means[c])
