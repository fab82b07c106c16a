"""Joint histograms for Mattes mutual information: box window on the fixed, cubic on the moving axis.

A cubic window is a polynomial in the place t of a sample between two bins, so a pass over the samples
only sums weight * (1, t, t^2, t^3) in each cell; the four bins' shares follow from these moments
afterwards. That is twice as fast as four windows a sample, and equal to rounding.
"""

import numpy as np

from regframe.kernels.jit import add_powers, kernel
from regframe.types import Cells, Matrix, Values, Volume

U = np.uint64
CHUNK = 64
EPSILON = float(np.finfo(np.float64).eps)


@kernel
def _locate(
    first: int,
    moving: Values,
    weight: Values,
    rows: Cells,
    axis: Values,
    bins: int,
    found: Matrix,
    count: int,
) -> None:
    """Cells, places between bins and weights of `count` samples, into (3, CHUNK); 0 weighs what is beyond."""
    low, high, scale, offset = axis[0], axis[1], axis[2], axis[3]
    cells, places, shares, last = found[0], found[1], found[2], np.float64(bins - 3)
    for k in range(count):
        # All three are read in any case: a branch would have to be taken sample by sample.
        value, share, row = moving[first + U(k)], weight[first + U(k)], np.float64(rows[first + U(k)])
        counts = (value >= low) & (value <= high)
        place = (value if counts else low) * scale - offset
        left = min(max(np.floor(place), 2.0), last)
        cells[k], places[k], shares[k] = row + left, place - left, share if counts else 0.0
    for k in range(count, CHUNK):
        cells[k] = places[k] = shares[k] = 0.0


@kernel
def moments(
    first: int,
    last: int,
    moving: Values,
    weight: Values,
    rows: Cells,
    axis: Values,
    bins: int,
    partial: Volume,
) -> None:
    """Per block: (bins * bins, 4) sums of weight * t**q by fixed bin and first moving bin.

    `rows` is bins * fixed bin; `axis` holds lowest and highest value, 1 / bin width and minimum in bins.
    """
    n, found = len(moving), np.empty((3, CHUNK))
    places, steps, shares = found[0], found[1], found[2]
    for block in range(first, last):
        cells = partial[block].ravel()
        cells[:] = 0.0
        end = n * (block + 1) // len(partial)
        for start in range(n * block // len(partial), end, CHUNK):
            count = min(CHUNK, end - start)
            _locate(U(start), moving, weight, rows, axis, bins, found, count)
            for k in range(U(0), U(count), U(4)):
                add_powers(cells, places, steps, shares, k)


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
def information(joint: Matrix) -> float:
    """Mutual information of a joint probability in nats, over the cells that ITK counts; -inf if none is.

    It counts a cell where it, its row and its column hold more than rounding noise.
    """
    fixed, moving, total, none = np.zeros(len(joint)), np.zeros(len(joint)), 0.0, True
    for k in range(len(joint)):
        for left in range(len(joint)):
            fixed[k] += joint[k, left]
            moving[left] += joint[k, left]
    for k in range(len(joint)):
        for left in range(len(joint)):
            share = joint[k, left]
            if share > EPSILON and fixed[k] > EPSILON and moving[left] > EPSILON:
                total += share * np.log(share / (fixed[k] * moving[left]))
                none = False
    return -np.inf if none else total


@kernel
def slopes(
    first: int,
    last: int,
    moving: Values,
    weight: Values,
    rows: Cells,
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
