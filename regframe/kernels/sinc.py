"""Windowed sinc interpolation, 2-D and 3-D: values.

Five pixels to each side, the rim's values repeated beyond it, as in ITK. Volumes are 3-D here: a 2-D image
is one slice. `matrix` is (3, 4), array order, and sums x first.
"""

import math

import numpy as np

from regframe.kernels.jit import kernel
from regframe.types import Bins, Indices, Matrix, Values, Volume

U = np.uint64
RUN = 256
RADIUS = 5
WINDOWS = ("hamming", "cosine", "welch", "lanczos", "blackman")


@kernel
def _start(row: int, i: int, grid: Bins, indices: Indices, at: Values) -> None:
    """Index of sample `i` of a row, z y x, into `at`."""
    if len(indices):
        at[0], at[1], at[2] = indices[i, 0], indices[i, 1], indices[i, 2]
    else:
        at[0], at[1] = float(row // grid[1]), float(row % grid[1])
        at[2] = float(i - row * grid[2])


@kernel
def _move(at: Values, matrix: Matrix, c: Values) -> None:
    for axis in range(3):
        c[axis] = ((matrix[axis, 2] * at[2] + matrix[axis, 1] * at[1]) + matrix[axis, 0] * at[0]) + matrix[
            axis, 3
        ]


@kernel
def _window(window: int, x: float) -> float:
    """The window at a distance of x pixels, in the order of `WINDOWS`."""
    turn = math.pi * x / RADIUS
    if window == 0:
        return 0.54 + 0.46 * math.cos(turn)
    if window == 1:
        return math.cos(0.5 * turn)
    if window == 2:
        return 1.0 - x * x / (RADIUS * RADIUS)
    if window == 3:
        return 1.0 if x == 0.0 else math.sin(turn) / turn
    return 0.42 + 0.5 * math.cos(turn) + 0.08 * math.cos(2.0 * turn)


@kernel
def _weigh(c: float, length: int, window: int, w: Values, taps: Bins) -> int:
    """Weights of the taps along one axis and their places; how many there are."""
    base = int(np.floor(c))
    way = c - base
    if way == 0.0:
        w[0], taps[0] = 1.0, base
        return 1
    # sin(pi x) of all taps is that of the first, with alternating signs; by the shorter way, because next to
    # a pixel its relative error becomes the weight's.
    sine = math.sin(math.pi * min(way, 1.0 - way)) / math.pi
    for k in range(2 * RADIUS):
        tap = base - RADIUS + 1 + k
        x = way + (RADIUS - 1 - k)
        sign = 1.0 if (RADIUS - 1 - k) % 2 == 0 else -1.0
        w[k] = _window(window, x) * (1.0 if x == 0.0 else sign * sine / x)
        taps[k] = min(max(tap, 0), length - 1)
    return 2 * RADIUS


@kernel
def _value(flat: Values, shape: Bins, w: Matrix, taps: Bins, count: Bins) -> float:
    total = 0.0
    for a in range(count[0]):
        for b in range(count[1]):
            o = U((taps[0, a] * shape[1] + taps[1, b]) * shape[2])
            row = 0.0
            for k in range(U(count[2])):
                row += w[2, k] * flat[o + U(taps[2, k])]
            total += w[0, a] * w[1, b] * row
    return total


@kernel
def resample(
    first: int,
    last: int,
    volume: Volume,
    window: int,
    grid: Bins,
    indices: Indices,
    matrix: Matrix,
    values: Values,
    weights: Values,
) -> None:
    """Values and inside weights of rows `first` to `last`; `window` counts in `WINDOWS`."""
    flat, shape = volume.ravel(), np.array(volume.shape)
    at, c, w = np.empty(3), np.empty(3), np.empty((3, 2 * RADIUS))
    taps, count = np.empty((3, 2 * RADIUS), np.int64), np.empty(3, np.int64)
    length = RUN if len(indices) else grid[2]
    for row in range(first, last):
        for i in range(row * length, min((row + 1) * length, len(values))):
            _start(row, i, grid, indices, at)
            _move(at, matrix, c)
            inside = True
            for axis in range(3):
                inside = inside and c[axis] >= -0.5 and c[axis] < shape[axis] - 0.5
            weights[U(i)] = 1.0 if inside else 0.0
            values[U(i)] = 0.0
            if inside:
                for axis in range(3):
                    count[axis] = _weigh(c[axis], shape[axis], window, w[axis], taps[axis])
                values[U(i)] = _value(flat, shape, w, taps, count)
