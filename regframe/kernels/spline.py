"""B-spline interpolation of order 0 to 5: prefilter, values, slopes.

After Unser, Aldroubi and Eden, "B-spline signal processing", IEEE Trans. Signal Processing 41(2), 1993,
with ITK's borders (mirror), its rounding of the coordinate to float32 before the support is chosen, and
its order of operations for order 3, so that order 3 gives ITK's bits. Volumes are 3-D here: a 2-D image
is one slice. `matrix` is (3, 4), array order, and sums x first.
"""

import numpy as np

from regframe.kernels.jit import kernel
from regframe.kernels.sharing import share
from regframe.types import Bins, Indices, Matrix, Values, Volume

U = np.uint64
RUN = 256
POLES: dict[int, tuple[float, ...]] = {
    0: (),
    1: (),
    2: (np.sqrt(8.0) - 3.0,),
    3: (np.sqrt(3.0) - 2.0,),
    4: (
        np.sqrt(664.0 - np.sqrt(438976.0)) + np.sqrt(304.0) - 19.0,
        np.sqrt(664.0 + np.sqrt(438976.0)) - np.sqrt(304.0) - 19.0,
    ),
    5: (
        np.sqrt(67.5 - np.sqrt(4436.25)) + np.sqrt(26.25) - 6.5,
        np.sqrt(67.5 + np.sqrt(4436.25)) - np.sqrt(26.25) - 6.5,
    ),
}


@kernel
def filter_lines(first: int, last: int, lines: Volume, poles: Values) -> None:
    """Turn samples into spline coefficients in place, along the rows of (lines, n)."""
    n = lines.shape[1]
    gain = 1.0
    for z in poles:
        gain = gain * (1.0 - z) * (1.0 - 1.0 / z)
    for row in range(first, last):
        y = lines[row]
        for k in range(n):
            y[k] *= gain
        for z in poles:
            y[0] = _first_causal(y, z)
            for k in range(1, n):
                y[k] += z * y[k - 1]
            y[n - 1] = (z / (z * z - 1.0)) * (z * y[n - 2] + y[n - 1])
            for k in range(n - 2, -1, -1):
                y[k] = z * (y[k + 1] - y[k])


def prefilter(samples: Volume, order: int) -> Volume:
    """Spline coefficients of samples, (ny, nx) or (nz, ny, nx), in a new array; the first axis last."""
    poles, coefficients = np.array(POLES[order]), np.array(samples, np.float64)
    if not len(poles):
        return coefficients
    for axis in range(samples.ndim - 1, -1, -1):
        if samples.shape[axis] > 1:
            turned = np.ascontiguousarray(np.moveaxis(coefficients, axis, -1))
            lines = turned.reshape(-1, samples.shape[axis])
            share(filter_lines, len(lines), lines, poles)
            coefficients = np.ascontiguousarray(np.moveaxis(turned, -1, axis))
    return coefficients


@kernel
def _first_causal(y: Values, z: float) -> float:
    n = len(y)
    horizon = int(np.ceil(np.log(1e-10) / np.log(np.abs(z))))
    power = z
    if horizon < n:
        total = y[0]
        for k in range(1, horizon):
            total += power * y[k]
            power *= z
        return total
    inverse = 1.0 / z
    mirror = z ** np.float64(n - 1)
    total = y[0] + mirror * y[n - 1]
    mirror = mirror * (mirror * inverse)
    for k in range(1, n - 1):
        total += (power + mirror) * y[k]
        power *= z
        mirror *= inverse
    return total / (1.0 - power * power)


@kernel
def _start(c: float, order: int) -> int:
    """First tap of the support of a coordinate; the float32 rounding is ITK's."""
    half = 0.5 if order % 2 == 0 else 0.0
    return int(np.floor(np.float64(np.float32(np.float64(np.float32(c)) + half)))) - order // 2


@kernel
def _quartic(t: float, w: Values) -> None:
    square = t * t
    sixth = square / 6.0
    w[0] = (0.5 - t) ** 4 / 24.0
    odd = t * (sixth - 11.0 / 24.0)
    even = 19.0 / 96.0 + square * (0.25 - sixth)
    w[1] = even + odd
    w[3] = even - odd
    w[4] = w[0] + odd + 0.5 * t
    w[2] = 1.0 - w[0] - w[1] - w[3] - w[4]


@kernel
def _quintic(t: float, w: Values) -> None:
    square = t * t
    w[5] = t * square * square / 120.0
    square -= t
    fourth = square * square
    t -= 0.5
    common = square * (square - 3.0)
    w[0] = (0.2 + square + fourth) / 24.0 - w[5]
    even = (square * (square - 5.0) + 9.2) / 24.0
    odd = -t * (common + 4.0) / 12.0
    w[2] = even + odd
    w[3] = even - odd
    even = (1.8 - common) / 16.0
    odd = t * (fourth - square - 5.0) / 24.0
    w[1] = even + odd
    w[4] = even - odd


@kernel
def _weights(order: int, t: float, w: Values) -> None:
    """Weights of the taps of a coordinate `t` behind tap number order // 2."""
    if order == 0:
        w[0] = 1.0
    elif order == 1:
        w[0] = 1.0 - t
        w[1] = t
    elif order == 2:
        w[0] = 0.5 * (0.5 - t) * (0.5 - t)
        w[1] = 0.75 - t * t
        w[2] = 0.5 * (t + 0.5) * (t + 0.5)
    elif order == 3:
        w[3] = (1.0 / 6.0) * t * t * t
        w[0] = (1.0 / 6.0) + 0.5 * t * (t - 1.0) - w[3]
        w[2] = t + w[0] - 2.0 * w[3]
        w[1] = 1.0 - w[0] - w[2] - w[3]
    elif order == 4:
        _quartic(t, w)
    else:
        _quintic(t, w)


@kernel
def _slopes(order: int, t: float, w: Values) -> None:
    """Derivatives of `_weights`: differences of the weights one order lower, half a pixel before."""
    w[order] = 0.0
    if order == 0:
        return
    _weights(order - 1, t - 0.5 if order % 2 else t + 0.5, w)
    for k in range(order, 0, -1):
        w[k] = w[k - 1] - w[k]
    w[0] = -w[0]


@kernel
def _taps(start: int, order: int, n: int, stride: int, taps: Bins) -> None:
    """Offsets of the taps of one axis, mirrored once at the ends."""
    for k in range(order + 1):
        i = start + k
        if n == 1:
            i = 0
        elif i < 0:
            i = -i
        elif i >= n - 1:
            i = 2 * (n - 1) - i
        taps[k] = min(max(i, 0), n - 1) * stride


@kernel
def _start_of(row: int, i: int, grid: Bins, indices: Indices, at: Values) -> None:
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
def _support(c: Values, order: int, shape: Bins, w: Matrix, taps: Bins) -> None:
    stride = 1
    for axis in range(2, -1, -1):
        if axis == 0 and shape[0] == 1:
            w[0, 0] = 1.0
            taps[0, 0] = 0
            continue
        start = _start(c[axis], order)
        _weights(order, c[axis] - (start + order // 2), w[axis])
        _taps(start, order, shape[axis], stride, taps[axis])
        stride *= shape[axis]


@kernel
def _value(flat: Values, wz: Values, w: Matrix, taps: Bins, count: Bins) -> float:
    total = 0.0
    for a in range(count[0]):
        for b in range(count[1]):
            row = U(taps[0, a] + taps[1, b])
            for k in range(count[2]):
                total += ((w[2, k] * w[1, b]) * wz[a]) * flat[row + U(taps[2, k])]
    return total


@kernel
def resample(
    first: int,
    last: int,
    coefficients: Volume,
    order: int,
    grid: Bins,
    indices: Indices,
    matrix: Matrix,
    values: Values,
    weights: Values,
) -> None:
    """Values and inside weights of rows `first` to `last`, any order, 2-D and 3-D."""
    flat, shape = coefficients.ravel(), np.array(coefficients.shape)
    at, c, w, taps = np.empty(3), np.empty(3), np.empty((3, 6)), np.empty((3, 6), np.int64)
    count = _counts(shape, order)
    length = RUN if len(indices) else grid[2]
    for row in range(first, last):
        for i in range(row * length, min((row + 1) * length, len(values))):
            _start_of(row, i, grid, indices, at)
            _move(at, matrix, c)
            inside = True
            for axis in range(3):
                inside = inside and c[axis] >= -0.5 and c[axis] < shape[axis] - 0.5
            weights[U(i)] = 1.0 if inside else 0.0
            values[U(i)] = 0.0
            if inside:
                _support(c, order, shape, w, taps)
                values[U(i)] = _value(flat, w[0], w, taps, count)


@kernel
def _counts(shape: Bins, order: int) -> Bins:
    count = np.full(3, order + 1)
    if shape[0] == 1:
        count[0] = 1
    return count


@kernel
def _slope_at(coefficients: Volume, order: int, c: Values, w: Matrix, taps: Bins, out: Values) -> None:
    """Slope of the spline at one position, z y x."""
    flat, shape = coefficients.ravel(), np.array(coefficients.shape)
    count, kept = _counts(shape, order), np.empty(6)
    _support(c, order, shape, w, taps)
    for axis in range(3):
        out[axis] = 0.0
        if shape[axis] == 1:
            continue
        kept[:] = w[axis]
        _slopes(order, c[axis] - (_start(c[axis], order) + order // 2), w[axis])
        out[axis] = _value(flat, w[0], w, taps, count)
        w[axis] = kept


@kernel
def gradient(
    first: int, last: int, coefficients: Volume, order: int, indices: Indices, slopes: Indices
) -> None:
    """Slopes (n, 3), z y x, at (n, 3) indices."""
    w, taps = np.empty((3, 6)), np.empty((3, 6), np.int64)
    for i in range(first, last):
        _slope_at(coefficients, order, indices[i], w, taps, slopes[i])


@kernel
def pull_back(
    first: int,
    last: int,
    coefficients: Volume,
    order: int,
    grid: Bins,
    indices: Indices,
    matrix: Matrix,
    forces: Values,
    partial: Volume,
) -> None:
    """Per block of rows: sum of forces * slope (x) [z, y, x, 1], into (blocks, 3, 4)."""
    at, c, g = np.ones(4), np.empty(3), np.empty(3)
    w, taps = np.empty((3, 6)), np.empty((3, 6), np.int64)
    length = RUN if len(indices) else grid[2]
    rows = (len(forces) + length - 1) // length
    for block in range(first, last):
        for row in range(rows * block // len(partial), rows * (block + 1) // len(partial)):
            for i in range(row * length, min((row + 1) * length, len(forces))):
                if forces[i] == 0.0:
                    continue
                _start_of(row, i, grid, indices, at)
                _move(at, matrix, c)
                _slope_at(coefficients, order, c, w, taps, g)
                for axis in range(3):
                    for column in range(4):
                        partial[block, axis, column] += forces[i] * g[axis] * at[column]
