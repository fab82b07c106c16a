"""Joint histograms for Mattes mutual information: box window on the fixed, cubic on the moving axis.

A cubic window is a polynomial in the place t of a sample between two bins, so a pass over the samples
only sums weight * (1, t, t^2, t^3) in each cell; the four bins' shares follow from these moments
afterwards. That is twice as fast as four windows a sample, and equal to rounding.
"""

import numpy as np

from regframe.kernels.jit import kernel
from regframe.types import Bins, Matrix, Values, Volume

U = np.uint64


@kernel
def moments(
    first: int,
    last: int,
    moving: Values,
    weight: Values,
    rows: Bins,
    axis: Values,
    bins: int,
    partial: Volume,
) -> None:
    """Per block: (bins * bins, 4) sums of weight * t**q by fixed bin and first moving bin.

    `rows` is bins * fixed bin; `axis` holds lowest and highest value, 1 / bin width and minimum in bins.
    """
    low, high, scale, offset = axis[0], axis[1], axis[2], axis[3]
    n = len(moving)
    for block in range(first, last):
        cells = partial[block].ravel()
        cells[:] = 0.0
        for i in range(U(n * block // len(partial)), U(n * (block + 1) // len(partial))):
            value, share = moving[i], weight[i]
            if share == 0.0 or value < low or value > high:
                continue
            place = value * scale - offset
            left = min(max(int(place), 2), bins - 3)
            t = place - left
            cell = U((rows[i] + left) * 4)
            cells[cell] += share
            share *= t
            cells[cell + U(1)] += share
            share *= t
            cells[cell + U(2)] += share
            cells[cell + U(3)] += share * t


@kernel
def histogram(partial: Volume, bins: int, joint: Matrix) -> None:
    """Sum the blocks in order and spread the moments over the four bins of each window."""
    sixth = 1.0 / 6.0
    for k in range(bins):
        for left in range(1, bins - 2):
            m0 = m1 = m2 = m3 = 0.0
            for block in range(len(partial)):
                cell = partial[block, k * bins + left]
                m0 += cell[0]
                m1 += cell[1]
                m2 += cell[2]
                m3 += cell[3]
            if m0 == 0.0:
                continue
            joint[k, left - 1] += sixth * (m0 - 3.0 * m1 + 3.0 * m2 - m3)
            joint[k, left] += sixth * (4.0 * m0 - 6.0 * m2 + 3.0 * m3)
            joint[k, left + 1] += sixth * (m0 + 3.0 * m1 + 3.0 * m2 - 3.0 * m3)
            joint[k, left + 2] += sixth * m3


@kernel
def slopes(
    first: int,
    last: int,
    moving: Values,
    weight: Values,
    rows: Bins,
    axis: Values,
    bins: int,
    table: Matrix,
    out: Values,
) -> None:
    """Each sample's weight * sum of table[k, bin] * d window / d bin place.

    `table` is (bins * bins, 3): the coefficients of 1, t and t^2 of that sum, by cell.
    """
    low, high, scale, offset = axis[0], axis[1], axis[2], axis[3]
    for i in range(U(first), U(last)):
        value, share = moving[i], weight[i]
        out[i] = 0.0
        if share == 0.0 or value < low or value > high:
            continue
        place = value * scale - offset
        left = min(max(int(place), 2), bins - 3)
        t = place - left
        cell = table[U(rows[i] + left)]
        out[i] = share * (cell[0] + t * (cell[1] + t * cell[2]))
