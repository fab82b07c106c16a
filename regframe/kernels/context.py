"""Squared differences between the neighbours of every point, and the way back.

Volumes are 3-D here: a 2-D image is one slice. `offsets` is (channels, 6): a neighbour's offset z y x, and
the other's. Beyond the border nothing has weight.
"""

import math

import numpy as np

from regframe.kernels.jit import kernel
from regframe.types import Bins, Matrix, Values, Volume

U = np.uint64


@kernel
def _span(length: int, one: int, other: int) -> tuple[int, int]:
    """First and last + 1 of the places whose two neighbours along an axis are inside."""
    return max(0, -one, -other), min(length, length - one, length - other)


@kernel
def differ(
    first: int, last: int, values: Volume, weight: Volume, offsets: Bins, squares: Volume, shares: Volume
) -> None:
    """Rows of all channels: both weights' product, and that times the squared difference."""
    depth, height, width = values.shape
    for row in range(first, last):
        channel, at = row // (depth * height), row % (depth * height)
        z, y = at // height, at % height
        o = offsets[channel]
        square, share = squares[channel, z, y], shares[channel, z, y]
        square[:] = 0.0
        share[:] = 0.0
        z_one, z_other, y_one, y_other = z + o[0], z + o[3], y + o[1], y + o[4]
        if min(z_one, z_other, y_one, y_other) < 0:
            continue
        if max(z_one, z_other) >= depth or max(y_one, y_other) >= height:
            continue
        one, other = values[z_one, y_one], values[z_other, y_other]
        one_weight, other_weight = weight[z_one, y_one], weight[z_other, y_other]
        begin, end = _span(width, o[2], o[5])
        for x in range(begin, end):
            both = one_weight[x + o[2]] * other_weight[x + o[5]]
            apart = one[x + o[2]] - other[x + o[5]]
            share[x] = both
            square[x] = both * apart * apart


@kernel
def describe(
    first: int,
    last: int,
    distances: Matrix,
    mass: Matrix,
    floor: float,
    channels: Matrix,
    variance: Values,
    least: Bins,
) -> None:
    """Of points `first` to `last`, (channels, n): exp(-distance / variance), about the least distance.

    `distances` holds sums of weighted squares and becomes these over their mass, less the least of each
    point. A point is not known, its mass 0 in all channels, unless all channels have some.
    """
    count = len(distances)
    for i in range(U(first), U(last)):
        known = True
        for channel in range(count):
            known = known and mass[channel, i] > 1e-6
        low, best, total = math.inf, 0, 0.0
        for channel in range(count):
            distance = 0.0
            if known:
                distance = distances[channel, i] / mass[channel, i]
            else:
                mass[channel, i] = 0.0
            distances[channel, i] = distance
            total += distance
            if distance < low:
                low, best = distance, channel
        spread = max(total / count - low, floor)
        for channel in range(count):
            distances[channel, i] -= low
            channels[channel, i] = math.exp(-distances[channel, i] / spread)
        variance[i], least[i] = spread, best


@kernel
def back(
    first: int, last: int, values: Volume, weight: Volume, offsets: Bins, slopes: Volume, out: Volume
) -> None:
    """Rows `first` to `last` of the slopes by intensity, of a number with these slopes by squared difference.

    Each point gathers from the places that it is a neighbour of, so that rows do not share sums.
    """
    depth, height, width = values.shape
    for row in range(first, last):
        z, y = row // height, row % height
        here, own, line = values[z, y], weight[z, y], out[z, y]
        line[:] = 0.0
        for channel in range(len(offsets)):
            o = offsets[channel]
            for side in range(2):
                near, far = 3 * side, 3 - 3 * side
                z_from, y_from = z - o[near], y - o[near + 1]
                z_far, y_far = z_from + o[far], y_from + o[far + 1]
                if min(z_from, y_from, z_far, y_far) < 0:
                    continue
                if max(z_from, z_far) >= depth or max(y_from, y_far) >= height:
                    continue
                slope = slopes[channel, z_from, y_from]
                other, other_weight = values[z_far, y_far], weight[z_far, y_far]
                shift, step = o[near + 2], o[far + 2] - o[near + 2]
                begin, end = _span(width, -shift, step)
                for x in range(begin, end):
                    both = own[x] * other_weight[x + step]
                    line[x] += 2.0 * slope[x - shift] * both * (here[x] - other[x + step])
