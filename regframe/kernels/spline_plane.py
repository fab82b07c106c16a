"""Cubic B-splines over whole 2-D grids: the case that decides how long a registration takes.

`resample` gives the numbers of `spline.resample` for order 3, to the last bit. Each row is walked in
chunks: one loop, which the compiler vectorises, finds taps and weights; a second one sums the taps.
`matrix` is (2, 3), y before x.
"""

import numpy as np

from regframe.kernels.jit import Four, columns, kernel, prefetch
from regframe.types import Bins, Matrix, Values, Volume

U = np.uint64
CHUNK = 64
SIXTH = 1.0 / 6.0
LINE = 7  # samples but one that share a line of memory
BORDER = -1.0  # in place of a tap: so near the image's border, or beyond, that taps are mirrored
OUTSIDE = -2.0


@kernel
def _locate(row: int, left: int, size: Bins, matrix: Matrix, t: Matrix, base: Values) -> None:
    """A chunk's first taps, and the ways t from the second ones (x, then y)."""
    height, width = np.float64(size[0]), np.float64(size[1])
    mxx, myx, mx0, my0 = matrix[1, 1], matrix[0, 1], matrix[1, 2], matrix[0, 2]
    shift_x, shift_y = matrix[1, 0] * row, matrix[0, 0] * row
    tx, ty = t[0], t[1]
    for k in range(CHUNK):
        x = np.float64(left + k)
        cx, cy = (mxx * x + shift_x) + mx0, (myx * x + shift_y) + my0
        # ITK rounds a coordinate to float32 before it takes the floor.
        floor_x, floor_y = np.floor(np.float64(np.float32(cx))), np.floor(np.float64(np.float32(cy)))
        inner_x = (floor_x >= 1.0) & (floor_x < width - 2.0)
        inner_y = (floor_y >= 1.0) & (floor_y < height - 2.0)
        tx[k], ty[k] = cx - floor_x, cy - floor_y
        near_x, near_y = (cx >= -1.0) & (cx < width), (cy >= -1.0) & (cy < height)
        first = (floor_y - 1.0) * width + (floor_x - 1.0)
        base[k] = first if inner_x & inner_y else (BORDER if near_x & near_y else OUTSIDE)


@kernel
def cubic(u: float) -> Four:
    """Weights of the four taps around a place, `u` behind the second one, in ITK's order of operations."""
    w3 = SIXTH * u * u * u
    w0 = SIXTH + 0.5 * u * (u - 1.0) - w3
    w2 = u + w0 - 2.0 * w3
    return w0, 1.0 - w0 - w2 - w3, w2, w3


@kernel
def cubic_slope(u: float) -> Four:
    """Derivatives of `cubic`."""
    before, after = 0.5 * (1.0 - u) * (1.0 - u), 0.5 * u * u
    middle = 0.75 - (u - 0.5) * (u - 0.5)
    return -before, before - middle, middle - after, after


@kernel
def _weigh(t: Values, w: Matrix) -> None:
    """Weights of a chunk, (4, CHUNK)."""
    first, second, third, fourth = w[0], w[1], w[2], w[3]
    for k in range(CHUNK):
        first[k], second[k], third[k], fourth[k] = cubic(t[k])


@kernel
def _tilt(t: Values, w: Matrix) -> None:
    """Derivatives of `_weigh`."""
    first, second, third, fourth = w[0], w[1], w[2], w[3]
    for k in range(CHUNK):
        first[k], second[k], third[k], fourth[k] = cubic_slope(t[k])


@kernel
def _mirrored(i: int, n: int) -> int:
    if i < 0:
        i = -i
    elif i >= n - 1:
        i = 2 * (n - 1) - i
    return min(max(i, 0), n - 1)


@kernel
def moved(y: float, x: float, matrix: Matrix) -> tuple[float, float]:
    """Where a place lies under an index map, y before x."""
    cx = (matrix[1, 1] * x + matrix[1, 0] * y) + matrix[1, 2]
    return (matrix[0, 1] * x + matrix[0, 0] * y) + matrix[0, 2], cx


@kernel
def inside(cy: float, cx: float, height: int, width: int) -> bool:
    """Whether a place lies in the image's pixels."""
    return cx >= -0.5 and cx < width - 0.5 and cy >= -0.5 and cy < height - 0.5


@kernel
def at_border(cy: float, cx: float, coefficients: Volume, x: Four, y: Four) -> float:
    """The sum over 16 taps, mirrored at the ends of the image."""
    height, width = coefficients.shape
    left = int(np.floor(np.float64(np.float32(cx)))) - 1
    top = int(np.floor(np.float64(np.float32(cy)))) - 1
    total = 0.0
    for j in range(4):
        for i in range(4):
            total += x[i] * y[j] * coefficients[_mirrored(top + j, height), _mirrored(left + i, width)]
    return total


@kernel
def taps(flat: Values, o: int, x: Four, y: float, total: float) -> float:
    """A sum, and one row of taps more."""
    total += x[0] * y * flat[o]
    total += x[1] * y * flat[o + U(1)]
    total += x[2] * y * flat[o + U(2)]
    total += x[3] * y * flat[o + U(3)]
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
    """Values and inside weights of grid rows `first` to `last`."""
    flat, size, stride = coefficients.ravel(), np.array(coefficients.shape), U(coefficients.shape[1])
    t, wx, wy, base = np.empty((2, CHUNK)), np.empty((4, CHUNK)), np.empty((4, CHUNK)), np.empty(CHUNK)
    for row in range(first, last):
        for left in range(0, grid_width, CHUNK):
            _locate(row, left, size, matrix, t, base)
            _weigh(t[0], wx)
            _weigh(t[1], wy)
            out = U(row * grid_width + left)
            for k in range(U(min(CHUNK, grid_width - left))):
                x, weight, total = (wx[0, k], wx[1, k], wx[2, k], wx[3, k]), 1.0, 0.0
                if base[k] >= 0.0:
                    o = U(np.int64(base[k]))
                    if k & U(LINE) == U(0):
                        prefetch(flat, o + U(4) * stride)  # what the next row of the grid will read
                    total = taps(flat, o, x, wy[0, k], total)
                    total = taps(flat, o + stride, x, wy[1, k], total)
                    total = taps(flat, o + stride + stride, x, wy[2, k], total)
                    total = taps(flat, o + stride + stride + stride, x, wy[3, k], total)
                else:
                    cy, cx = moved(np.float64(row), np.float64(left + np.int64(k)), matrix)
                    weight = 1.0 if base[k] == BORDER and inside(cy, cx, size[0], size[1]) else 0.0
                    if weight:
                        y = (wy[0, k], wy[1, k], wy[2, k], wy[3, k])
                        total = at_border(cy, cx, coefficients, x, y)
                values[out + k] = total
                weights[out + k] = weight


@kernel
def along(x: Four, taps: Four) -> float:
    """The sum of four products."""
    return (x[0] * taps[0] + x[1] * taps[1]) + (x[2] * taps[2] + x[3] * taps[3])


@kernel
def _pull_chunk(
    row: int, left: int, coefficients: Volume, matrix: Matrix, forces: Values, w: Volume, base: Values
) -> tuple[float, float, float, float]:
    """Sums over a chunk: force * slope along y and x, and both times the column."""
    flat, stride, size = coefficients.ravel(), U(coefficients.shape[1]), np.array(coefficients.shape)
    wx, wy, vx, vy = w[0], w[1], w[2], w[3]
    gy = gx = gyx = gxx = 0.0
    for k in range(U(len(forces))):
        if forces[k] == 0.0:
            continue
        x, dx = (wx[0, k], wx[1, k], wx[2, k], wx[3, k]), (vx[0, k], vx[1, k], vx[2, k], vx[3, k])
        y, dy = (wy[0, k], wy[1, k], wy[2, k], wy[3, k]), (vy[0, k], vy[1, k], vy[2, k], vy[3, k])
        if base[k] >= 0.0:
            o = U(np.int64(base[k]))
            if k & U(LINE) == U(0):
                prefetch(flat, o + U(4) * stride)
            slopes = along(x, columns(flat, o, stride, dy)), along(dx, columns(flat, o, stride, y))
        else:
            cy, cx = moved(np.float64(row), np.float64(left) + np.float64(k), matrix)
            if base[k] != BORDER or not inside(cy, cx, size[0], size[1]):
                continue
            slopes = at_border(cy, cx, coefficients, x, dy), at_border(cy, cx, coefficients, dx, y)
        column = np.float64(left) + np.float64(k)
        down, right = forces[k] * slopes[0], forces[k] * slopes[1]
        gy, gx, gyx, gxx = gy + down, gx + right, gyx + down * column, gxx + right * column
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
    size, height, width = np.array(coefficients.shape), grid[0], grid[1]
    t, w, base = np.empty((2, CHUNK)), np.empty((4, 4, CHUNK)), np.empty(CHUNK)
    for block in range(first, last):
        for row in range(height * block // len(partial), height * (block + 1) // len(partial)):
            for left in range(0, width, CHUNK):
                _locate(row, left, size, matrix, t, base)
                for axis in range(2):
                    _weigh(t[axis], w[axis])
                    _tilt(t[axis], w[2 + axis])
                felt = forces[row * width + left : row * width + min(left + CHUNK, width)]
                gy, gx, gyx, gxx = _pull_chunk(row, left, coefficients, matrix, felt, w, base)
                partial[block, 0, 0] += gy * row
                partial[block, 0, 1] += gyx
                partial[block, 0, 2] += gy
                partial[block, 1, 0] += gx * row
                partial[block, 1, 1] += gxx
                partial[block, 1, 2] += gx
