"""Smoothing by short symmetric filters, zero beyond the border: each filter is its own adjoint.

Zero borders keep sums simple where a weight is smoothed along with the values and divided out
(normalised convolution), and where slopes are walked back through the same filter.
"""

import math
from collections.abc import Callable

import numpy as np

from regframe.kernels.jit import kernel, share
from regframe.types import Matrix, Values, Volume

U = np.uint64
ALONE = 2**16
"""Numbers below which a thread of its own costs more than it saves."""


def gaussian_taps(sigma: float) -> Values:
    """Half of a sampled Gaussian that sums to 1, the centre first; cut at 2.6 sigma.

    Examples
    --------
    >>> gaussian_taps(0.5).round(3)
    array([0.787, 0.107])
    """
    reach = max(1, math.floor(2.6 * sigma + 0.5))
    half = np.exp(-0.5 * (np.arange(reach + 1) / sigma) ** 2)
    return np.asarray(half / (half[0] + 2.0 * half[1:].sum()))


def blur(stack: Volume, taps: Values, axes: int) -> Volume:
    """Each image of a stack, filtered along its last `axes` axes.

    Parameters
    ----------
    stack : (..., ny, nx) float64, C-contiguous
    taps : (r + 1,) float64
        Half of the filter, the centre first.
    axes : int
    """
    source = np.ascontiguousarray(stack)
    for axis in range(stack.ndim - axes, stack.ndim):
        length = stack.shape[axis]
        if length == 1:
            source = source * taps[0]
            continue
        width = stack.shape[-1]
        out = np.empty_like(source)
        rows = source.size // width
        if axis == stack.ndim - 1:
            split(_along_rows, rows, width, source.reshape(rows, width), taps, out.reshape(rows, width))
        else:
            step = int(np.prod(stack.shape[axis + 1 : -1], dtype=np.int64))
            flat = (source.reshape(rows, width), taps, out.reshape(rows, width))
            split(_across_rows, rows, width, *flat, step, length)
        source = out
    return source


def split(function: Callable[..., object], rows: int, width: int, *arguments: object) -> None:
    """Share rows among threads, unless there are too few numbers to gain by it."""
    if rows * width < ALONE:
        function(0, rows, *arguments)
    else:
        share(function, rows, *arguments)


@kernel
def _along_rows(first: int, last: int, source: Matrix, taps: Values, out: Matrix) -> None:
    width, reach = source.shape[1], len(taps) - 1
    padded = np.zeros(width + 2 * reach)
    for row in range(first, last):
        for x in range(width):
            padded[U(x + reach)] = source[row, U(x)]
        line = out[row]
        for x in range(U(width)):
            line[x] = taps[0] * padded[x + U(reach)]
        for k in range(1, reach + 1):
            tap, left, right = taps[k], U(reach - k), U(reach + k)
            for x in range(U(width)):
                line[x] += tap * (padded[x + left] + padded[x + right])


@kernel
def _across_rows(
    first: int, last: int, source: Matrix, taps: Values, out: Matrix, step: int, length: int
) -> None:
    """Rows `step` apart are neighbours, `length` of them in a line."""
    width = source.shape[1]
    for row in range(first, last):
        at, line, here = (row // step) % length, out[row], source[row]
        for x in range(U(width)):
            line[x] = taps[0] * here[x]
        for k in range(1, len(taps)):
            tap = taps[k]
            if at - k >= 0 and at + k < length:
                above, below = source[row - k * step], source[row + k * step]
                for x in range(U(width)):
                    line[x] += tap * (above[x] + below[x])
            elif at - k >= 0 or at + k < length:
                near = source[row - k * step] if at - k >= 0 else source[row + k * step]
                for x in range(U(width)):
                    line[x] += tap * near[x]
