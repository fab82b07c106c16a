"""Interpolation by a Gaussian's mass over each pixel, 2-D and 3-D: values, slopes, and the heaviest label.

After ITK's Gaussian interpolators: weights are differences of the error function over the extent of each
pixel within reach, cut at the image's rim. Volumes are 3-D here: a 2-D image is one slice. `matrix` is
(3, 4), array order, and sums x first; `setting` holds sigma and reach, in pixels.
"""

import math

import numpy as np

from regframe.kernels.jit import kernel
from regframe.types import Bins, Indices, Matrix, Values, Volume

U = np.uint64
RUN = 256


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
def _inside(c: Values, shape: Bins) -> bool:
    inside = True
    for axis in range(3):
        inside = inside and c[axis] >= -0.5 and c[axis] < shape[axis] - 0.5
    return inside


@kernel
def _taps(setting: Values) -> int:
    """No more pixels than this are within reach along an axis."""
    return math.ceil(2.0 * setting[1]) + 2


@kernel
def _weigh(c: Values, shape: Bins, setting: Values, w: Matrix, first: Bins, count: Bins) -> None:
    """The pixels within reach along each axis, and the Gaussian's mass over each, times 2."""
    factor = 1.0 / (math.sqrt(2.0) * setting[0])
    for axis in range(3):
        begin = max(0, int(np.floor(c[axis] + 0.5 - setting[1])))
        end = min(shape[axis], int(np.ceil(c[axis] + 0.5 + setting[1])))
        t = (begin - 0.5 - c[axis]) * factor
        before = math.erf(t)
        for k in range(end - begin):
            t += factor
            now = math.erf(t)
            w[axis, k] = now - before
            before = now
        first[axis], count[axis] = begin, end - begin


@kernel
def _value(flat: Values, shape: Bins, w: Matrix, first: Bins, count: Bins) -> float:
    """Weighted mean."""
    total, mass = 0.0, 0.0
    for a in range(count[0]):
        for b in range(count[1]):
            o = U(((first[0] + a) * shape[1] + first[1] + b) * shape[2] + first[2])
            plane = w[0, a] * w[1, b]
            for k in range(U(count[2])):
                weight = w[2, k] * plane
                total += weight * flat[o + k]
                mass += weight
    return total / mass


@kernel
def resample(
    start: int,
    last: int,
    volume: Volume,
    setting: Values,
    grid: Bins,
    indices: Indices,
    matrix: Matrix,
    values: Values,
    weights: Values,
) -> None:
    """Values and inside weights of rows `start` to `last`."""
    flat, shape = volume.ravel(), np.array(volume.shape)
    at, c, w = np.empty(3), np.empty(3), np.empty((3, _taps(setting)))
    first, count = np.empty(3, np.int64), np.empty(3, np.int64)
    length = RUN if len(indices) else grid[2]
    for row in range(start, last):
        for i in range(row * length, min((row + 1) * length, len(values))):
            _start(row, i, grid, indices, at)
            _move(at, matrix, c)
            inside = _inside(c, shape)
            value = 0.0
            if inside:
                _weigh(c, shape, setting, w, first, count)
                value = _value(flat, shape, w, first, count)
            values[U(i)] = value
            weights[U(i)] = 1.0 if inside else 0.0


@kernel
def _heaviest(
    flat: Values, shape: Bins, w: Matrix, first: Bins, count: Bins, labels: Values, sums: Values
) -> float:
    """The label whose weights sum to most; of equals the first to get there, x fastest."""
    met, most, best = 0, 0.0, 0.0
    for a in range(count[0]):
        for b in range(count[1]):
            o = U(((first[0] + a) * shape[1] + first[1] + b) * shape[2] + first[2])
            for k in range(U(count[2])):
                label, place = flat[o + k], 0
                while place < met and labels[place] != label:
                    place += 1
                if place == met:
                    labels[place], sums[place] = label, 0.0
                    met += 1
                sums[place] += w[0, a] * w[1, b] * w[2, k]
                if sums[place] > most:
                    most, best = sums[place], label
    return best


@kernel
def resample_labels(
    start: int,
    last: int,
    volume: Volume,
    setting: Values,
    grid: Bins,
    indices: Indices,
    matrix: Matrix,
    values: Values,
    weights: Values,
) -> None:
    """As `resample`, but the heaviest label in place of the mean."""
    flat, shape = volume.ravel(), np.array(volume.shape)
    at, c, w = np.empty(3), np.empty(3), np.empty((3, _taps(setting)))
    first, count = np.empty(3, np.int64), np.empty(3, np.int64)
    labels, sums = np.empty(_taps(setting) ** 3), np.empty(_taps(setting) ** 3)
    length = RUN if len(indices) else grid[2]
    for row in range(start, last):
        for i in range(row * length, min((row + 1) * length, len(values))):
            _start(row, i, grid, indices, at)
            _move(at, matrix, c)
            inside = _inside(c, shape)
            value = 0.0
            if inside:
                _weigh(c, shape, setting, w, first, count)
                value = _heaviest(flat, shape, w, first, count, labels, sums)
            values[U(i)] = value
            weights[U(i)] = 1.0 if inside else 0.0


@kernel
def _tilt(c: Values, setting: Values, first: Bins, count: Bins, d: Matrix) -> None:
    """Derivatives of `_weigh` by the coordinate."""
    factor = 1.0 / (math.sqrt(2.0) * setting[0])
    height = 2.0 * factor / math.sqrt(math.pi)
    for axis in range(3):
        for k in range(count[axis]):
            left = (first[axis] + k - 0.5 - c[axis]) * factor
            right = left + factor
            d[axis, k] = height * (math.exp(-left * left) - math.exp(-right * right))


@kernel
def _slope_at(flat: Values, shape: Bins, w: Matrix, d: Matrix, first: Bins, count: Bins, out: Values) -> None:
    """Slope of the weighted mean, z y x."""
    total, mass, along_x, along_y, along_z = 0.0, 1.0, 0.0, 0.0, 0.0
    for a in range(count[0]):
        for b in range(count[1]):
            o = U(((first[0] + a) * shape[1] + first[1] + b) * shape[2] + first[2])
            row, leaned = 0.0, 0.0
            for k in range(U(count[2])):
                row += w[2, k] * flat[o + k]
                leaned += d[2, k] * flat[o + k]
            total += w[0, a] * w[1, b] * row
            along_x += w[0, a] * w[1, b] * leaned
            along_y += w[0, a] * d[1, b] * row
            along_z += d[0, a] * w[1, b] * row
    for axis in range(3):
        mass *= w[axis, : count[axis]].sum()
    out[0], out[1], out[2] = along_z, along_y, along_x
    for axis in range(3):
        share = d[axis, : count[axis]].sum() / w[axis, : count[axis]].sum()
        out[axis] = (out[axis] - total * share) / mass


@kernel
def gradient(
    start: int, last: int, volume: Volume, setting: Values, indices: Indices, slopes: Indices
) -> None:
    """Slopes (n, 3), z y x, at (n, 3) indices, inside or nearly."""
    flat, shape = volume.ravel(), np.array(volume.shape)
    w, d = np.empty((3, _taps(setting))), np.empty((3, _taps(setting)))
    first, count = np.empty(3, np.int64), np.empty(3, np.int64)
    for i in range(start, last):
        _weigh(indices[i], shape, setting, w, first, count)
        _tilt(indices[i], setting, first, count, d)
        _slope_at(flat, shape, w, d, first, count, slopes[i])
