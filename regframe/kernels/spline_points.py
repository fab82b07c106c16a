"""Cubic B-splines at stored places of a plane: what maps with bends, and sparse samples, ask for.

`resample` gives the numbers of `spline.resample` for order 3, to the last bit. Indices are (n, 2) and
`matrix` is (2, 3), y before x.
"""

import numpy as np

from regframe.kernels.jit import columns, kernel
from regframe.kernels.spline_plane import U, along, at_border, cubic, cubic_slope, inside, moved, taps
from regframe.types import Indices, Matrix, Values, Volume


@kernel
def _floor(c: float) -> float:
    return np.floor(np.float64(np.float32(c)))  # ITK rounds a coordinate to float32 before it takes the floor


@kernel
def _inner(cy: float, cx: float, height: int, width: int) -> bool:
    """Whether no tap is mirrored."""
    y, x = _floor(cy), _floor(cx)
    return y >= 1.0 and y < height - 2.0 and x >= 1.0 and x < width - 2.0


@kernel
def resample(
    first: int,
    last: int,
    coefficients: Volume,
    indices: Indices,
    matrix: Matrix,
    values: Values,
    weights: Values,
) -> None:
    """Values and inside weights of places `first` to `last`."""
    flat, (height, width), stride = coefficients.ravel(), coefficients.shape, U(coefficients.shape[1])
    for i in range(first, last):
        cy, cx = moved(indices[i, 0], indices[i, 1], matrix)
        values[i] = weights[i] = 0.0
        if not inside(cy, cx, height, width):
            continue
        top, left = _floor(cy), _floor(cx)
        x, y, total = cubic(cx - left), cubic(cy - top), 0.0
        if _inner(cy, cx, height, width):
            o = U(np.int64((top - 1.0) * width + (left - 1.0)))
            total = taps(flat, o, x, y[0], total)
            total = taps(flat, o + stride, x, y[1], total)
            total = taps(flat, o + stride + stride, x, y[2], total)
            total = taps(flat, o + stride + stride + stride, x, y[3], total)
        else:
            total = at_border(cy, cx, coefficients, x, y)
        values[i], weights[i] = total, 1.0


@kernel
def gradient(first: int, last: int, coefficients: Volume, indices: Indices, slopes: Indices) -> None:
    """Slopes (n, 2) along y and x at places `first` to `last`."""
    flat, (height, width), stride = coefficients.ravel(), coefficients.shape, U(coefficients.shape[1])
    for i in range(first, last):
        cy, cx = indices[i, 0], indices[i, 1]
        top, left = _floor(cy), _floor(cx)
        x, y, dx, dy = cubic(cx - left), cubic(cy - top), cubic_slope(cx - left), cubic_slope(cy - top)
        if _inner(cy, cx, height, width):
            o = U(np.int64((top - 1.0) * width + (left - 1.0)))
            slopes[i, 0] = along(x, columns(flat, o, stride, dy))
            slopes[i, 1] = along(dx, columns(flat, o, stride, y))
        else:
            slopes[i, 0] = at_border(cy, cx, coefficients, x, dy)
            slopes[i, 1] = at_border(cy, cx, coefficients, dx, y)
