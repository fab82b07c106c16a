"""Linear and cubic B-spline interpolation of one position, tap by tap."""

import itertools
import math

import numpy as np


def mirrored(i, n):
    if n == 1:
        return 0
    i = abs(i)
    return 2 * (n - 1) - i if i >= n - 1 else i


def hat(u):
    return max(1 - abs(u), 0.0)


def cubic(u):
    u = abs(u)
    if u < 1:
        return 2 / 3 - u**2 + u**3 / 2
    return (2 - u) ** 3 / 6 if u < 2 else 0.0


def linear(volume, index):
    """Clamped at the edges, so constant over the outer half pixel."""
    index = [min(max(c, 0.0), n - 1.0) for c, n in zip(index, volume.shape, strict=True)]
    return taps(volume, index, hat, 1)


def spline(coefficients, index):
    return taps(coefficients, index, cubic, 2)


def taps(volume, index, kernel, reach):
    total = 0.0
    for corner in itertools.product(range(-reach, reach + 1), repeat=volume.ndim):
        place = [math.floor(c) + k for c, k in zip(index, corner, strict=True)]
        share = math.prod(kernel(c - p) for c, p in zip(index, place, strict=True))
        total += share * volume[tuple(mirrored(p, n) for p, n in zip(place, volume.shape, strict=True))]
    return total


def coefficients(line):
    """Cubic coefficients of a line: the mirrored interpolation equations, solved outright."""
    n = len(line)
    system = np.zeros((n, n))
    for i in range(n):
        for k in (-1, 0, 1):
            system[i, mirrored(i + k, n)] += cubic(k)
    return np.linalg.solve(system, line)
