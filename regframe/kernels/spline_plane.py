"""Cubic B-splines over whole 2-D grids: the case that decides how long a registration takes.

`resample` gives the numbers of `spline.resample` for order 3, to the last bit. Each row is walked in
chunks: one loop, which vectorises, finds positions and weights; a second one sums the taps.
"""

import numpy as np

from regframe.kernels.jit import kernel
from regframe.types import Bins, Matrix, Values, Volume

U = np.uint64
CHUNK = 64
OUTSIDE, BORDER, INTERIOR = 0, 1, 2
SIXTH = 1.0 / 6.0

Work = tuple[Matrix, Bins, Bins, Bins]  # offsets, taps, places of one chunk; the image's size


@kernel
def _locate(
    row: int, left: int, count: int, size: Bins, matrix: Matrix, w: Matrix, taps: Bins, place: Bins
) -> None:
    """Offsets from the second tap (x, y), the first tap (row, column, memory), and where it lies."""
    height, width = size[0], size[1]
    mxx, myx = matrix[1, 1], matrix[0, 1]
    shift_x, shift_y, mx0, my0 = matrix[1, 0] * row, matrix[0, 0] * row, matrix[1, 2], matrix[0, 2]
    tx, ty = w[0], w[1]
    for k in range(U(count)):
        x = np.float64(left) + np.float64(k)
        cx = (mxx * x + shift_x) + mx0
        cy = (myx * x + shift_y) + my0
        inside = (cx >= -0.5) & (cx < width - 0.5) & (cy >= -0.5) & (cy < height - 0.5)
        cx = cx if inside else 1.0
        cy = cy if inside else 1.0
        floor_x = np.floor(np.float64(np.float32(cx)))
        floor_y = np.floor(np.float64(np.float32(cy)))
        interior = (floor_x >= 1.0) & (floor_x < width - 2.0) & (floor_y >= 1.0) & (floor_y < height - 2.0)
        place[k] = (INTERIOR if interior else BORDER) if inside else OUTSIDE
        tx[k] = cx - floor_x
        ty[k] = cy - floor_y
        taps[0, k] = np.int64(np.int32(floor_y) - 1)
        taps[1, k] = np.int64(np.int32(floor_x) - 1)
        taps[2, k] = taps[0, k] * width + taps[1, k]


@kernel
def _row(flat: Values, o: int, x: tuple[float, float, float, float], y: float, total: float) -> float:
    total += x[0] * y * flat[o]
    total += x[1] * y * flat[o + U(1)]
    total += x[2] * y * flat[o + U(2)]
    total += x[3] * y * flat[o + U(3)]
    return total


@kernel
def _cubic(t: float) -> tuple[float, float, float, float]:
    w3 = SIXTH * t * t * t
    w0 = SIXTH + 0.5 * t * (t - 1.0) - w3
    w2 = t + w0 - 2.0 * w3
    return w0, 1.0 - w0 - w2 - w3, w2, w3


@kernel
def _cubic_slope(t: float) -> tuple[float, float, float, float]:
    before, after = 0.5 * (1.0 - t) * (1.0 - t), 0.5 * t * t
    middle = 0.75 - (t - 0.5) * (t - 0.5)
    return -before, before - middle, middle - after, after


@kernel
def _mirrored(i: int, n: int) -> int:
    if i < 0:
        i = -i
    elif i >= n - 1:
        i = 2 * (n - 1) - i
    return min(max(i, 0), n - 1)


@kernel
def _at_border(
    coefficients: Volume,
    tap: Bins,
    x: tuple[float, float, float, float],
    y: tuple[float, float, float, float],
) -> float:
    """The sum over 16 taps, mirrored at the ends of the image."""
    height, width = coefficients.shape
    top, left = tap[0], tap[1]
    total = 0.0
    for j in range(4):
        for i in range(4):
            total += x[i] * y[j] * coefficients[_mirrored(top + j, height), _mirrored(left + i, width)]
    return total


@kernel
def resample(
    first: int,
    last: int,
    coefficients: Volume,
    grid_width: int,
    matrix: Matrix,
    values: Values,
    weights: Values,
) -> None:
    """Values and inside weights of grid rows `first` to `last`; `matrix` is (2, 3), y before x."""
    flat, stride = coefficients.ravel(), U(coefficients.shape[1])
    size = np.array(coefficients.shape)
    w, taps, place = np.empty((2, CHUNK)), np.empty((3, CHUNK), np.int64), np.empty(CHUNK, np.int64)
    for row in range(first, last):
        for left in range(0, grid_width, CHUNK):
            count = min(CHUNK, grid_width - left)
            _locate(row, left, count, size, matrix, w, taps, place)
            out = U(row * grid_width + left)
            for k in range(U(count)):
                total = 0.0
                if place[k] != OUTSIDE:
                    x, y = _cubic(w[0, k]), _cubic(w[1, k])
                    if place[k] == INTERIOR:
                        o = U(taps[2, k])
                        total = _row(flat, o, x, y[0], total)
                        total = _row(flat, o + stride, x, y[1], total)
                        total = _row(flat, o + stride + stride, x, y[2], total)
                        total = _row(flat, o + stride + stride + stride, x, y[3], total)
                    else:
                        total = _at_border(coefficients, taps[:, k], x, y)
                values[out + k] = total
                weights[out + k] = 1.0 if place[k] != OUTSIDE else 0.0


@kernel
def _slope(flat: Values, o: int, stride: int, t_x: float, t_y: float) -> tuple[float, float]:
    """Slopes along y and x over 16 taps inside the image."""
    x, y, dx, dy = _cubic(t_x), _cubic(t_y), _cubic_slope(t_x), _cubic_slope(t_y)
    slope_y = slope_x = 0.0
    for j in range(4):
        a, b, c, d = flat[o], flat[o + U(1)], flat[o + U(2)], flat[o + U(3)]
        slope_y += dy[j] * (x[0] * a + x[1] * b + x[2] * c + x[3] * d)
        slope_x += y[j] * (dx[0] * a + dx[1] * b + dx[2] * c + dx[3] * d)
        o += stride
    return slope_y, slope_x


@kernel
def _pull_row(
    row: int, coefficients: Volume, width: int, matrix: Matrix, forces: Values, work: Work
) -> tuple[float, float, float, float]:
    """Sums over a grid row: force * slope along y and x, and both times the column."""
    flat, stride = coefficients.ravel(), U(coefficients.shape[1])
    w, taps, place, size = work
    gy = gx = gyx = gxx = 0.0
    for left in range(0, width, CHUNK):
        count = min(CHUNK, width - left)
        _locate(row, left, count, size, matrix, w, taps, place)
        out = U(row * width + left)
        for k in range(U(count)):
            force = forces[out + k]
            if place[k] == OUTSIDE or force == 0.0:
                continue
            if place[k] == INTERIOR:
                slope_y, slope_x = _slope(flat, U(taps[2, k]), stride, w[0, k], w[1, k])
            else:
                x, y = _cubic(w[0, k]), _cubic(w[1, k])
                slope_y = _at_border(coefficients, taps[:, k], x, _cubic_slope(w[1, k]))
                slope_x = _at_border(coefficients, taps[:, k], _cubic_slope(w[0, k]), y)
            column = np.float64(left) + np.float64(k)
            gy += force * slope_y
            gx += force * slope_x
            gyx += force * slope_y * column
            gxx += force * slope_x * column
    return gy, gx, gyx, gxx


@kernel
def pull_back(
    first: int,
    last: int,
    coefficients: Volume,
    grid: Bins,
    matrix: Matrix,
    forces: Values,
    partial: Volume,
) -> None:
    """Per block of rows: sum of forces * slope (x) [y, x, 1], into (blocks, 2, 3)."""
    size = np.array(coefficients.shape)
    work = (np.empty((2, CHUNK)), np.empty((3, CHUNK), np.int64), np.empty(CHUNK, np.int64), size)
    height, width = grid[0], grid[1]
    for block in range(first, last):
        for row in range(height * block // len(partial), height * (block + 1) // len(partial)):
            gy, gx, gyx, gxx = _pull_row(row, coefficients, width, matrix, forces, work)
            partial[block, 0, 0] += gy * row
            partial[block, 0, 1] += gyx
            partial[block, 0, 2] += gy
            partial[block, 1, 0] += gx * row
            partial[block, 1, 1] += gxx
            partial[block, 1, 2] += gx
