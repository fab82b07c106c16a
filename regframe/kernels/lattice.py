"""Displacements by a lattice of control points: tensor B-splines of order 2 and 3, 2-D and 3-D.

Coefficients are (dim, nz, ny, nx), one lattice a direction of motion, x first; a plane has one slice.
Indices are continuous positions in the lattice, z y x, with z = 0 in a plane.
"""

import numpy as np

from regframe.kernels.jit import kernel
from regframe.types import Bins, Indices, Matrix, Points, Values

U = np.uint64


@kernel
def _weigh(c: float, order: int, w: Values) -> int:
    """Weights of the support of a coordinate; its first control point."""
    first = int(np.floor(c + 0.5 - order / 2.0))
    for k in range(order + 1):
        u = abs(c - (first + k))
        if order == 3:
            if u < 1.0:
                w[k] = (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0
            else:
                w[k] = (8.0 - 12.0 * u + 6.0 * u * u - u * u * u) / 6.0 if u < 2.0 else 0.0
        elif u < 0.5:
            w[k] = 0.75 - u * u
        else:
            w[k] = (9.0 - 12.0 * u + 4.0 * u * u) / 8.0 if u < 1.5 else 0.0
    return first


@kernel
def _support(c: Values, shape: Bins, order: int, w: Matrix, first: Bins, count: Bins) -> bool:
    """Weights, first control point and number of them along each axis; false where the spline ends."""
    margin = 0.5 * (order - 1)
    for axis in range(3):
        if axis == 0 and shape[0] == 1:
            w[0, 0], first[0], count[0] = 1.0, 0, 1
            continue
        limit, at = shape[axis] - margin - 1.0, c[axis]
        last_bits = 4.0 * np.spacing(limit)
        if abs(at - limit) <= last_bits:
            at = limit - 1.5 * last_bits
        if not (at >= margin and at < limit):
            return False
        first[axis], count[axis] = _weigh(at, order, w[axis]), order + 1
    return True


@kernel
def displace(
    start: int, last: int, coefficients: Values, shape: Bins, order: int, indices: Indices, out: Points
) -> None:
    """Add the displacements (n, dim) at (n, 3) indices to `out`; nothing where the spline ends."""
    w, first, count = np.empty((3, 4)), np.empty(3, np.int64), np.empty(3, np.int64)
    size = U(shape[0] * shape[1] * shape[2])
    for i in range(start, last):
        if not _support(indices[i], shape, order, w, first, count):
            continue
        for axis in range(out.shape[1]):
            total = 0.0
            for a in range(count[0]):
                for b in range(count[1]):
                    o = U(((first[0] + a) * shape[1] + first[1] + b) * shape[2] + first[2]) + U(axis) * size
                    plane = w[0, a] * w[1, b]
                    for k in range(U(count[2])):
                        total += (w[2, k] * plane) * coefficients[o + k]
            out[i, axis] += total


@kernel
def scatter(
    start: int, last: int, shape: Bins, order: int, indices: Indices, forces: Points, partial: Matrix
) -> None:
    """Per block of points: sum of forces times weights, into (blocks, p)."""
    w, first, count = np.empty((3, 4)), np.empty(3, np.int64), np.empty(3, np.int64)
    size = U(shape[0] * shape[1] * shape[2])
    number, blocks = len(indices), len(partial)
    for block in range(start, last):
        total = partial[block]
        for i in range(number * block // blocks, number * (block + 1) // blocks):
            if not _support(indices[i], shape, order, w, first, count):
                continue
            for axis in range(forces.shape[1]):
                force = forces[i, axis]
                for a in range(count[0]):
                    for b in range(count[1]):
                        o = (
                            U(((first[0] + a) * shape[1] + first[1] + b) * shape[2] + first[2])
                            + U(axis) * size
                        )
                        pull = force * (w[0, a] * w[1, b])
                        for k in range(U(count[2])):
                            total[o + k] += w[2, k] * pull


@kernel
def spread(first: int, last: int, order: int, places: Values, reach: Values) -> None:
    """Largest weight of each control point of an axis at any of the places along it."""
    w = np.empty(4)
    for i in range(first, last):
        begin = _weigh(places[i], order, w)
        for k in range(order + 1):
            if 0 <= begin + k < len(reach):
                reach[begin + k] = max(reach[begin + k], w[k])
