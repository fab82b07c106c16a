"""Smoothing by short symmetric filters, zero beyond the border: each filter is its own adjoint.

Zero borders keep sums simple where a weight is smoothed along with the values and divided out
(normalised convolution), and where slopes are walked back through the same filter.
"""

import math
from collections.abc import Callable

import numpy as np

from regframe.kernels.jit import kernel
from regframe.kernels.sharing import share
from regframe.types import Bins, Matrix, Values, Volume

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


def blur(stack: Volume, taps: Values, axes: int, out: Volume | None = None) -> Volume:
    """Each image of a stack, filtered along its last `axes` axes, 2 or 3.

    Parameters
    ----------
    stack : (..., ny, nx) float64
    taps : (r + 1,) float64
        Half of the filter, the centre first.
    axes : int
    out : (..., ny, nx) float64, optional
        Memory for the result, which is returned.
    """
    height, width = stack.shape[-2:]
    source = np.ascontiguousarray(stack, np.float64)
    out = np.empty(stack.shape) if out is None else out
    rows = stack.size // width
    split(_in_planes, rows, width, source.reshape(rows, width), taps, out.reshape(rows, width), height)
    if axes == 2:
        return out
    inner = out.copy()
    given = (inner.reshape(rows, width), taps, out.reshape(rows, width), height, stack.shape[-3])
    split(_across_rows, rows, width, *given)
    return out


def split(function: Callable[..., object], rows: int, width: int, *arguments: object) -> None:
    """Share rows among threads, unless there are too few numbers to gain by it."""
    if rows * width < ALONE:
        function(0, rows, *arguments)
    else:
        share(function, rows, *arguments)


@kernel
def _along(here: Values, t: Values, padded: Values, line: Values) -> None:
    """One row, filtered; `padded` is zero at both ends."""
    width, reach = len(line), len(t) - 1
    for x in range(U(width)):
        padded[x + U(reach)] = here[x]
    if reach == SHORT:
        # One pass in place of four: most of the time goes by here.
        t0, t1, t2, t3 = t[0], t[1], t[2], t[3]
        for x in range(U(width)):
            line[x] = (
                t0 * padded[x + U(3)]
                + t1 * (padded[x + U(2)] + padded[x + U(4)])
                + t2 * (padded[x + U(1)] + padded[x + U(5)])
                + t3 * (padded[x] + padded[x + U(6)])
            )
        return
    for x in range(U(width)):
        line[x] = t[0] * padded[x + U(reach)]
    for k in range(1, reach + 1):
        tap, left, right = t[k], U(reach - k), U(reach + k)
        for x in range(U(width)):
            line[x] += tap * (padded[x + left] + padded[x + right])


@kernel
def _combine(lines: Matrix, t: Values, at: Bins, line: Values) -> None:
    """Weighted sum of the rows of `lines` that `at` names, the middle one first, then pairs."""
    width, here = len(line), lines[at[0]]
    if len(t) - 1 == SHORT:
        t0, t1, t2, t3 = t[0], t[1], t[2], t[3]
        a1, b1, a2, b2, a3, b3 = (
            lines[at[1]],
            lines[at[2]],
            lines[at[3]],
            lines[at[4]],
            lines[at[5]],
            lines[at[6]],
        )
        for x in range(U(width)):
            line[x] = t0 * here[x] + t1 * (a1[x] + b1[x]) + t2 * (a2[x] + b2[x]) + t3 * (a3[x] + b3[x])
        return
    for x in range(U(width)):
        line[x] = t[0] * here[x]
    for k in range(1, len(t)):
        tap, above, below = t[k], lines[at[2 * k - 1]], lines[at[2 * k]]
        for x in range(U(width)):
            line[x] += tap * (above[x] + below[x])


@kernel
def _whole(taps: Values) -> Values:
    """The taps, with zeros where there are few."""
    t = np.zeros(max(len(taps) - 1, SHORT) + 1)
    t[: len(taps)] = taps
    return t


@kernel
def _in_planes(first: int, last: int, source: Matrix, taps: Values, out: Matrix, height: int) -> None:
    """Filter along rows, and across them; `height` of them are a plane. Filtered rows wait in a ring."""
    t = _whole(taps)
    width, reach = source.shape[1], len(t) - 1
    count = 2 * reach + 1
    lines, padded, at = np.zeros((count + 1, width)), np.zeros(width + 2 * reach), np.empty(count, np.int64)
    for row in range(first, last):
        y = row % height
        fresh = y - reach if row == first or y == 0 else y + reach
        for one in range(max(fresh, 0), min(y + reach, height - 1) + 1):
            _along(source[row - y + one], t, padded, lines[one % count])
        at[0] = y % count
        for k in range(1, reach + 1):
            at[2 * k - 1] = (y - k) % count if y >= k else count
            at[2 * k] = (y + k) % count if y + k < height else count
        _combine(lines, t, at, out[row])


@kernel
def _across_rows(
    first: int, last: int, source: Matrix, taps: Values, out: Matrix, step: int, length: int
) -> None:
    """Rows `step` apart are neighbours, `length` of them in a line."""
    t = _whole(taps)
    reach, zeros = len(t) - 1, np.zeros(source.shape[1])
    for row in range(first, last):
        place, line, here = (row // step) % length, out[row], source[row]
        for x in range(U(len(line))):
            line[x] = t[0] * here[x]
        for k in range(1, reach + 1):
            tap = t[k]
            above = source[row - k * step] if place - k >= 0 else zeros
            below = source[row + k * step] if place + k < length else zeros
            for x in range(U(len(line))):
                line[x] += tap * (above[x] + below[x])
