"""Nearest and linear interpolation, 2-D and 3-D: values and slopes.

Volumes are 3-D here: a 2-D image is one slice. `matrix` is (3, 4), array order, and sums x first. Work is
shared by rows: rows of the grid, or runs of `RUN` stored indices when the grid is not sampled whole.
"""

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
        c[axis] = ((matrix[axis, 2] * at[2] + matrix[axis, 1] * at[1]) + matrix[axis, 0] * at[0]) + matrix[axis, 3]


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
def _slope(flat: Values, shape: Bins, c: Values, out: Values) -> None:
    """Slope of the linear interpolation, z y x; 0 over the outer half pixel."""
    strides = (shape[1] * shape[2], shape[2], 1)
    base, t, step = np.empty(3, np.int64), np.empty(3), np.empty(3, np.int64)
    for axis in range(3):
        base[axis] = int(max(np.floor(c[axis]), 0.0))
        t[axis] = max(c[axis] - base[axis], 0.0)
        step[axis] = strides[axis] if base[axis] < shape[axis] - 1 and c[axis] >= 0.0 else 0
        out[axis] = 0.0
    o = base[0] * strides[0] + base[1] * strides[1] + base[2]
    for corner in range(8):
        a, b, k = corner >> 2, (corner >> 1) & 1, corner & 1
        value = flat[U(o + a * step[0] + b * step[1] + k * step[2])]
        wz, wy, wx = (t[0] if a else 1.0 - t[0]), (t[1] if b else 1.0 - t[1]), (t[2] if k else 1.0 - t[2])
        out[0] += (1.0 if a else -1.0) * wy * wx * value
        out[1] += (1.0 if b else -1.0) * wz * wx * value
        out[2] += (1.0 if k else -1.0) * wz * wy * value


@kernel
def gradient(first: int, last: int, volume: Volume, indices: Indices, slopes: Indices) -> None:
    """Slopes (n, 3), z y x, at (n, 3) indices."""
    flat, shape = volume.ravel(), np.array(volume.shape)
    for i in range(first, last):
        _slope(flat, shape, indices[i], slopes[i])


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
    at, c, g = np.ones(4), np.empty(3), np.empty(3)
    length = RUN if len(indices) else grid[2]
    rows = (len(forces) + length - 1) // length
    for block in range(first, last):
        for row in range(rows * block // len(partial), rows * (block + 1) // len(partial)):
            for i in range(row * length, min((row + 1) * length, len(forces))):
                if forces[i] == 0.0:
                    continue
                _start(row, i, grid, indices, at)
                _move(at, matrix, c)
                _slope(flat, shape, c, g)
                for axis in range(3):
                    for column in range(4):
                        partial[block, axis, column] += forces[i] * g[axis] * at[column]
