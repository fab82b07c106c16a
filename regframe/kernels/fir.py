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

SHORT = 3
"""Most taps to either side of the filters that are unrolled."""


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
    stack : (..., ny, nx) float64
    taps : (r + 1,) float64
        Half of the filter, the centre first.
    axes : int
    """
    source, spare = np.array(stack, np.float64, order="C"), np.empty(stack.shape)
    width = stack.shape[-1]
    rows = stack.size // width
    for axis in range(stack.ndim - axes, stack.ndim):
        flat = (source.reshape(rows, width), taps, spare.reshape(rows, width))
        if axis == stack.ndim - 1:
            split(_along_rows, rows, width, *flat)
        else:
            step = int(np.prod(stack.shape[axis + 1 : -1], dtype=np.int64))
            split(_across_rows, rows, width, *flat, step, stack.shape[axis])
        # Two blocks of memory in turns: fresh pages cost as much as the sums.
        source, spare = spare, source
    return source


def split(function: Callable[..., object], rows: int, width: int, *arguments: object) -> None:
    """Share rows among threads, unless there are too few numbers to gain by it."""
    if rows * width < ALONE:
        function(0, rows, *arguments)
    else:
        share(function, rows, *arguments)


@kernel
def _along_rows(first: int, last: int, source: Matrix, taps: Values, out: Matrix) -> None:
    width, reach = source.shape[1], max(len(taps) - 1, SHORT)
    t = np.zeros(reach + 1)
    t[: len(taps)] = taps
    padded = np.zeros(width + 2 * reach)
    for row in range(first, last):
        here, line = source[row], out[row]
        for x in range(U(width)):
            padded[x + U(reach)] = here[x]
        if reach == SHORT:
            # One pass in place of four: most of the time goes by here.
            for x in range(U(width)):
                line[x] = (
                    t[0] * padded[x + U(3)]
                    + t[1] * (padded[x + U(2)] + padded[x + U(4)])
                    + t[2] * (padded[x + U(1)] + padded[x + U(5)])
                    + t[3] * (padded[x] + padded[x + U(6)])
                )
            continue
        for x in range(U(width)):
            line[x] = t[0] * padded[x + U(reach)]
        for k in range(1, reach + 1):
            tap, left, right = t[k], U(reach - k), U(reach + k)
            for x in range(U(width)):
                line[x] += tap * (padded[x + left] + padded[x + right])


@kernel
def _across_rows(
    first: int, last: int, source: Matrix, taps: Values, out: Matrix, step: int, length: int
) -> None:
    """Rows `step` apart are neighbours, `length` of them in a line."""
    width, reach = source.shape[1], max(len(taps) - 1, SHORT)
    t = np.zeros(reach + 1)
    t[: len(taps)] = taps
    zeros = np.zeros(width)
    for row in range(first, last):
        at, line, here = (row // step) % length, out[row], source[row]
        if reach == SHORT:
            a1 = source[row - step] if at >= 1 else zeros
            b1 = source[row + step] if at + 1 < length else zeros
            a2 = source[row - 2 * step] if at >= 2 else zeros
            b2 = source[row + 2 * step] if at + 2 < length else zeros
            a3 = source[row - 3 * step] if at >= 3 else zeros
            b3 = source[row + 3 * step] if at + 3 < length else zeros
            for x in range(U(width)):
                line[x] = (
                    t[0] * here[x] + t[1] * (a1[x] + b1[x]) + t[2] * (a2[x] + b2[x]) + t[3] * (a3[x] + b3[x])
                )
            continue
        for x in range(U(width)):
            line[x] = t[0] * here[x]
        for k in range(1, len(taps)):
            tap = t[k]
            above = source[row - k * step] if at - k >= 0 else zeros
            below = source[row + k * step] if at + k < length else zeros
            for x in range(U(width)):
                line[x] += tap * (above[x] + below[x])
