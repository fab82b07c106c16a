"""Displacements by a field of vectors, linear between its points, 2-D and 3-D.

Fields are flat (nz * ny * nx * dim), the components of a vector side by side, x first; a plane has one
slice. Indices are continuous positions in the field, z y x, with z = 0 in a plane.
"""

import numpy as np

from regframe.kernels.jit import kernel
from regframe.types import Bins, Indices, Matrix, Points, Values


@kernel
def _cell(c: Values, shape: Bins, at: Bins, t: Matrix) -> bool:
    """Lower and upper neighbour along each axis, (3, 2), and their weights; false outside the field."""
    for axis in range(3):
        last = shape[axis] - 1
        if not (c[axis] >= -0.5 and c[axis] < last + 0.5):
            return False
        base = int(np.floor(c[axis]))
        t[axis, 1] = c[axis] - base
        t[axis, 0] = 1.0 - t[axis, 1]
        at[axis, 0], at[axis, 1] = max(base, 0), min(base + 1, last)
    return True


@kernel
def displace(start: int, last: int, field: Values, shape: Bins, indices: Indices, out: Points) -> None:
    """Add the displacements (n, dim) at (n, 3) indices to `out`; nothing outside the field."""
    at, t, dim = np.empty((3, 2), np.int64), np.empty((3, 2)), out.shape[1]
    for i in range(start, last):
        if not _cell(indices[i], shape, at, t):
            continue
        for axis in range(dim):
            total = 0.0
            for corner in range(8):
                a, b, d = corner >> 2, (corner >> 1) & 1, corner & 1
                weight = t[2, d] * t[1, b] * t[0, a]
                if weight != 0.0:
                    place = (at[0, a] * shape[1] + at[1, b]) * shape[2] + at[2, d]
                    total += weight * field[place * dim + axis]
            out[i, axis] += total


@kernel
def scatter(shape: Bins, indices: Indices, forces: Points, field: Values) -> None:
    """Add forces (n, dim) at (n, 3) indices to the field's points, by their weights there.

    On one thread: a sum of its own a block of points would take a field's memory many times.
    """
    at, t, dim = np.empty((3, 2), np.int64), np.empty((3, 2)), forces.shape[1]
    for i in range(len(indices)):
        if not _cell(indices[i], shape, at, t):
            continue
        for corner in range(8):
            a, b, d = corner >> 2, (corner >> 1) & 1, corner & 1
            weight = t[2, d] * t[1, b] * t[0, a]
            if weight != 0.0:
                place = (at[0, a] * shape[1] + at[1, b]) * shape[2] + at[2, d]
                for axis in range(dim):
                    field[place * dim + axis] += weight * forces[i, axis]
