"""Nearest and linear interpolation, 2-D and 3-D: values and slopes.

Volumes are 3-D here: a 2-D image is one slice. `matrix` is (3, 4), array order, and sums x first. Work is
shared by rows: rows of the grid, or runs of `RUN` stored indices when the grid is not sampled whole.
"""

import numpy as np

from regframe.kernels.jit import blend, kernel, prefetch
from regframe.types import Bins, Indices, Matrix, Values, Volume

U = np.uint64
RUN = 256
CHUNK = 64
LINE = 8  # samples that share a line of memory
BORDER = -1.0  # in place of a corner: in the outer half pixel of the image, or near enough to need a look
OUTSIDE = -2.0

Three = tuple[float, float, float]


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
    return (
        c[2] >= -0.5
        and c[2] < shape[2] - 0.5
        and c[1] >= -0.5
        and c[1] < shape[1] - 0.5
        and c[0] >= -0.5
        and c[0] < shape[0] - 0.5
    )


@kernel
def _along(flat: Values, o: int, step: int, t: float) -> float:
    return flat[o] + (flat[o + step] - flat[o]) * t


@kernel
def _linear(flat: Values, shape: Bins, c: Values) -> float:
    """ITK's order: along x, then y, then z; constant over the outer half pixel."""
    bx, by, bz = max(np.floor(c[2]), 0.0), max(np.floor(c[1]), 0.0), max(np.floor(c[0]), 0.0)
    tx, ty, tz = max(c[2] - bx, 0.0), max(c[1] - by, 0.0), max(c[0] - bz, 0.0)
    ix, iy, iz = int(bx), int(by), int(bz)
    sx = U(1 if ix < shape[2] - 1 else 0)
    sy = U(shape[2] if iy < shape[1] - 1 else 0)
    o = U((iz * shape[1] + iy) * shape[2] + ix)
    low = _along(flat, o, sx, tx)
    low = low + (_along(flat, o + sy, sx, tx) - low) * ty
    if shape[0] == 1 or tz == 0.0:
        return low
    o = o + U(shape[1] * shape[2] if iz < shape[0] - 1 else 0)
    high = _along(flat, o, sx, tx)
    high = high + (_along(flat, o + sy, sx, tx) - high) * ty
    return low + (high - low) * tz


@kernel
def _nearest(flat: Values, shape: Bins, c: Values) -> float:
    """Ties go up."""
    iz, iy, ix = int(np.floor(c[0] + 0.5)), int(np.floor(c[1] + 0.5)), int(np.floor(c[2] + 0.5))
    return flat[U((iz * shape[1] + iy) * shape[2] + ix)]


@kernel
def resample(
    first: int,
    last: int,
    volume: Volume,
    order: int,
    grid: Bins,
    indices: Indices,
    matrix: Matrix,
    values: Values,
    weights: Values,
) -> None:
    """Values and inside weights of rows `first` to `last`; order 0 is nearest, 1 linear."""
    flat, shape = volume.ravel(), np.array(volume.shape)
    at, c = np.empty(3), np.empty(3)
    length = RUN if len(indices) else grid[2]
    for row in range(first, last):
        for i in range(row * length, min((row + 1) * length, len(values))):
            _start(row, i, grid, indices, at)
            _move(at, matrix, c)
            inside = _inside(c, shape)
            value = 0.0
            if inside:
                value = _linear(flat, shape, c) if order == 1 else _nearest(flat, shape, c)
            values[U(i)] = value
            weights[U(i)] = 1.0 if inside else 0.0


@kernel
def _locate_plane(row: int, left: int, shape: Bins, matrix: Matrix, t: Matrix, base: Values) -> None:
    """A chunk's first corners, and the ways (x, y) from them; OUTSIDE or BORDER where there is none.

    `t` holds the ways z, y, x and the columns 0 to CHUNK - 1.
    """
    last_y, last_x, width = np.float64(shape[1] - 1), np.float64(shape[2] - 1), np.float64(shape[2])
    mx, my, x1, y1 = matrix[2, 2], matrix[1, 2], matrix[2, 1] * row, matrix[1, 1] * row
    x3, y3, tx, ty, columns, start = matrix[2, 3], matrix[1, 3], t[2], t[1], t[3], np.float64(left)
    for k in range(CHUNK):
        x = start + columns[k]
        cx, cy = (mx * x + x1) + x3, (my * x + y1) + y3
        floor_x, floor_y = np.floor(cx), np.floor(cy)
        tx[k], ty[k] = cx - floor_x, cy - floor_y
        base[k] = floor_y * width + floor_x
    inner = 0
    for k in range(0, CHUNK, CHUNK - 1):
        x = start + columns[k]
        cx, cy = (mx * x + x1) + x3, (my * x + y1) + y3
        inner += (cx >= 0.0) & (cx < last_x) & (cy >= 0.0) & (cy < last_y)
    if inner == 2:  # both ends: all, for rounding keeps order, so a coordinate rises or falls all along a row
        return
    for k in range(CHUNK):
        x = start + columns[k]
        cx, cy = (mx * x + x1) + x3, (my * x + y1) + y3
        inner = (cx >= 0.0) & (cx < last_x) & (cy >= 0.0) & (cy < last_y)
        near = (cx >= -1.0) & (cx < last_x + 1.0) & (cy >= -1.0) & (cy < last_y + 1.0)
        base[k] = base[k] if inner else (BORDER if near else OUTSIDE)


@kernel
def _locate_space(
    row: int, left: int, grid: Bins, shape: Bins, matrix: Matrix, t: Matrix, base: Values
) -> None:
    """The same in 3-D."""
    z, y = np.float64(row // grid[1]), np.float64(row % grid[1])
    last_z, last_y, last_x = np.float64(shape[0] - 1), np.float64(shape[1] - 1), np.float64(shape[2] - 1)
    plane, width = np.float64(shape[1] * shape[2]), np.float64(shape[2])
    mz, my, mx = matrix[0, 2], matrix[1, 2], matrix[2, 2]
    z1, y1, x1 = matrix[0, 1] * y, matrix[1, 1] * y, matrix[2, 1] * y
    z2, y2, x2 = matrix[0, 0] * z, matrix[1, 0] * z, matrix[2, 0] * z
    z3, y3, x3 = matrix[0, 3], matrix[1, 3], matrix[2, 3]
    tz, ty, tx, columns, start = t[0], t[1], t[2], t[3], np.float64(left)
    for k in range(CHUNK):
        x = start + columns[k]
        cx, cy, cz = ((mx * x + x1) + x2) + x3, ((my * x + y1) + y2) + y3, ((mz * x + z1) + z2) + z3
        floor_x, floor_y, floor_z = np.floor(cx), np.floor(cy), np.floor(cz)
        inner = (cx >= 0.0) & (cx < last_x) & (cy >= 0.0) & (cy < last_y) & (cz >= 0.0) & (cz < last_z)
        near = (cx >= -1.0) & (cx < last_x + 1.0) & (cy >= -1.0) & (cy < last_y + 1.0)
        near = near & (cz >= -1.0) & (cz < last_z + 1.0)
        tx[k], ty[k], tz[k] = cx - floor_x, cy - floor_y, cz - floor_z
        base[k] = (floor_z * plane + floor_y * width) + floor_x if inner else (BORDER if near else OUTSIDE)


@kernel
def _chunk() -> tuple[Matrix, Values]:
    """Room for `t` and `base` of a chunk; `t` ends with room for values."""
    t = np.empty((5, CHUNK))
    for k in range(CHUNK):
        t[3, k] = k
    return t, np.empty(CHUNK)


@kernel
def resample_grid(
    first: int, last: int, volume: Volume, grid: Bins, matrix: Matrix, values: Values, weights: Values
) -> None:
    """`resample` of order 1 for whole grids, the same bits; four samples are blended as one."""
    flat, shape = volume.ravel(), np.array(volume.shape)
    planar = shape[0] == 1 and grid[0] == 1 and matrix[0, 3] == 0.0
    plane, width = U(0 if planar else shape[1] * shape[2]), U(shape[2])
    (t, base), at, c, none = _chunk(), np.empty(3), np.empty(3), np.empty((0, 3))
    tz, ty, tx, high = t[0], t[1], t[2], t[4]
    for row in range(first, last):
        for left in range(0, grid[2], CHUNK):
            if planar:
                _locate_plane(row, left, shape, matrix, t, base)
            else:
                _locate_space(row, left, grid, shape, matrix, t, base)
            for k in range(0, CHUNK, LINE):
                prefetch(flat, U(np.int64(base[k])) + width + width)
            out, k, count = U(row * grid[2] + left), U(0), U(min(CHUNK, grid[2] - left))
            while k < count:
                # A row enters the inside once and leaves it once: between two inner samples are inner ones.
                if k + U(3) < count and base[k] >= 0.0 and base[k + U(3)] >= 0.0:
                    blend(values, out + k, flat, base, k, U(0), width, tx, ty)
                    if plane:
                        blend(high, k, flat, base, k, plane, width, tx, ty)
                        for i in range(U(4)):
                            low = values[out + k + i]
                            values[out + k + i] = low + (high[k + i] - low) * tz[k + i]
                    for i in range(U(4)):
                        weights[out + k + i] = 1.0
                    k += U(4)
                    continue
                values[out + k] = weights[out + k] = 0.0
                if base[k] != OUTSIDE:
                    _start(row, row * grid[2] + left + np.int64(k), grid, none, at)
                    _move(at, matrix, c)
                    if _inside(c, shape):
                        values[out + k], weights[out + k] = _linear(flat, shape, c), 1.0
                k += U(1)


@kernel
def _slope(flat: Values, shape: Bins, c: Values) -> tuple[float, float, float]:
    """Slope of the linear interpolation, z y x; 0 over the outer half pixel."""
    cx, cy, cz = max(c[2], 0.0), max(c[1], 0.0), max(c[0], 0.0)
    ix, iy, iz = int(cx), int(cy), int(cz)
    tx, ty, tz = cx - ix, cy - iy, cz - iz
    sx = U(ix < shape[2] - 1 and c[2] >= 0.0)
    sy = U(shape[2] if iy < shape[1] - 1 and c[1] >= 0.0 else 0)
    sz = U(shape[1] * shape[2] if iz < shape[0] - 1 and c[0] >= 0.0 else 0)
    o = U((iz * shape[1] + iy) * shape[2] + ix)
    a, b, d, e = flat[o], flat[o + sx], flat[o + sy], flat[o + sy + sx]
    low, low_x = _bilinear(a, b, d, e, tx, ty), (b - a) * (1.0 - ty) + (e - d) * ty
    low_y = (d - a) * (1.0 - tx) + (e - b) * tx
    if sz == U(0):
        return 0.0, low_y, low_x
    o += sz
    a, b, d, e = flat[o], flat[o + sx], flat[o + sy], flat[o + sy + sx]
    high_x, high_y = (b - a) * (1.0 - ty) + (e - d) * ty, (d - a) * (1.0 - tx) + (e - b) * tx
    along = _bilinear(a, b, d, e, tx, ty) - low
    return along, low_y * (1.0 - tz) + high_y * tz, low_x * (1.0 - tz) + high_x * tz


@kernel
def _bilinear(a: float, b: float, d: float, e: float, tx: float, ty: float) -> float:
    low = a + (b - a) * tx
    return low + ((d + (e - d) * tx) - low) * ty


@kernel
def gradient(first: int, last: int, volume: Volume, indices: Indices, slopes: Indices) -> None:
    """Slopes (n, 3), z y x, at (n, 3) indices."""
    flat, shape = volume.ravel(), np.array(volume.shape)
    for i in range(first, last):
        slopes[i, 0], slopes[i, 1], slopes[i, 2] = _slope(flat, shape, indices[i])


@kernel
def pull_back(
    first: int,
    last: int,
    volume: Volume,
    grid: Bins,
    indices: Indices,
    matrix: Matrix,
    forces: Values,
    partial: Volume,
) -> None:
    """Per block of rows: sum of forces * slope (x) [z, y, x, 1], into (blocks, 3, 4)."""
    flat, shape = volume.ravel(), np.array(volume.shape)
    at, c = np.ones(4), np.empty(3)
    length = RUN if len(indices) else grid[2]
    rows = (len(forces) + length - 1) // length
    for block in range(first, last):
        for row in range(rows * block // len(partial), rows * (block + 1) // len(partial)):
            for i in range(row * length, min((row + 1) * length, len(forces))):
                if forces[i] == 0.0:
                    continue
                _start(row, i, grid, indices, at)
                _move(at, matrix, c)
                slopes = _slope(flat, shape, c)
                for axis in range(3):
                    pull = forces[i] * slopes[axis]
                    partial[block, axis, 0] += pull * at[0]
                    partial[block, axis, 1] += pull * at[1]
                    partial[block, axis, 2] += pull * at[2]
                    partial[block, axis, 3] += pull


@kernel
def _tilt(flat: Values, o: int, width: int, plane: int, t: Matrix, k: int, planar: bool) -> Three:
    """Slopes z y x between the corners from `o` on; along z 0 where there is one slice."""
    tx, ty, tz = t[2, k], t[1, k], t[0, k]
    a, b, d, e = flat[o], flat[o + U(1)], flat[o + width], flat[o + width + U(1)]
    low_x, low_y = (b - a) * (1.0 - ty) + (e - d) * ty, (d - a) * (1.0 - tx) + (e - b) * tx
    if planar:
        return 0.0, low_y, low_x
    low, o = _bilinear(a, b, d, e, tx, ty), o + plane
    a, b, d, e = flat[o], flat[o + U(1)], flat[o + width], flat[o + width + U(1)]
    high_x, high_y = (b - a) * (1.0 - ty) + (e - d) * ty, (d - a) * (1.0 - tx) + (e - b) * tx
    along = _bilinear(a, b, d, e, tx, ty) - low
    return along, low_y * (1.0 - tz) + high_y * tz, low_x * (1.0 - tz) + high_x * tz


@kernel
def _pull_chunk(
    row: int,
    left: int,
    volume: Volume,
    grid: Bins,
    matrix: Matrix,
    felt: Values,
    t: Matrix,
    base: Values,
    sums: Matrix,
) -> None:
    """A chunk's sums of force * slope, z y x, and of both times the column, into (2, 3)."""
    flat, shape = volume.ravel(), np.array(volume.shape)
    plane, width, planar = U(shape[1] * shape[2]), U(shape[2]), shape[0] == 1
    at, c, none = np.empty(3), np.empty(3), np.empty((0, 3))
    gz = gy = gx = cz = cy = cx = 0.0
    for k in range(U(len(felt))):
        if felt[k] == 0.0 or base[k] == OUTSIDE:
            continue
        if base[k] >= 0.0:
            o = U(np.int64(base[k]))
            if k % U(LINE) == U(0):
                prefetch(flat, o + width + width)  # what the next row of the grid will read
            slopes = _tilt(flat, o, width, plane, t, k, planar)
        else:
            _start(row, row * grid[2] + left + np.int64(k), grid, none, at)
            _move(at, matrix, c)
            slopes = _slope(flat, shape, c)
        column = np.float64(left) + np.float64(k)
        z, y, x = felt[k] * slopes[0], felt[k] * slopes[1], felt[k] * slopes[2]
        gz, gy, gx = gz + z, gy + y, gx + x
        cz, cy, cx = cz + z * column, cy + y * column, cx + x * column
    sums[0, 0], sums[0, 1], sums[0, 2] = gz, gy, gx
    sums[1, 0], sums[1, 1], sums[1, 2] = cz, cy, cx


@kernel
def pull_back_grid(
    first: int, last: int, volume: Volume, grid: Bins, matrix: Matrix, forces: Values, partial: Volume
) -> None:
    """`pull_back` for whole grids, its sums taken row by row."""
    shape, rows, sums = np.array(volume.shape), grid[0] * grid[1], np.empty((2, 3))
    t, base = _chunk()
    planar = shape[0] == 1 and grid[0] == 1 and matrix[0, 3] == 0.0
    for block in range(first, last):
        for row in range(rows * block // len(partial), rows * (block + 1) // len(partial)):
            z, y = np.float64(row // grid[1]), np.float64(row % grid[1])
            for left in range(0, grid[2], CHUNK):
                if planar:
                    _locate_plane(row, left, shape, matrix, t, base)
                else:
                    _locate_space(row, left, grid, shape, matrix, t, base)
                felt = forces[row * grid[2] + left : row * grid[2] + min(left + CHUNK, grid[2])]
                _pull_chunk(row, left, volume, grid, matrix, felt, t, base, sums)
                for axis in range(3):
                    partial[block, axis, 0] += sums[0, axis] * z
                    partial[block, axis, 1] += sums[0, axis] * y
                    partial[block, axis, 2] += sums[1, axis]
                    partial[block, axis, 3] += sums[0, axis]
