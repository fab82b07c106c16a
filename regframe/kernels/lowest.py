"""The few lowest places of a table of translations."""

import numpy as np
from numpy.typing import NDArray

from regframe.kernels.jit import kernel
from regframe.types import Scores


def lowest(
    scored: Scores,
    shared: Scores,
    within: tuple[NDArray[np.int64], NDArray[np.int64]],
    least: float,
    most: int,
    apart: int,
) -> NDArray[np.int64]:
    """Row and column of the lowest scores, the lowest first, (k, 2).

    Parameters
    ----------
    scored : (ny, nx) array
        Goes round: the last row and the first are neighbours, as are the columns.
    shared : (ny, nx) array
        What meets at each translation.
    within : pair of int arrays
        Rows and columns that may be taken.
    least : float
        Of `shared`, for a translation to be taken.
    most : int
        How many are wanted.
    apart : int
        None lies within so many rows and columns of one before it.
    """
    found = np.empty((most, 2), np.int64)
    return found[: _lowest(scored, shared, *within, least, apart, found)]


@kernel
def _apart(at: int, other: int, count: int) -> int:
    step = abs(at - other)
    return min(step, count - step)


@kernel
def _lowest(
    scored: Scores,
    shared: Scores,
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
    least: float,
    apart: int,
    found: NDArray[np.int64],
) -> int:
    ny, nx = scored.shape
    for k in range(len(found)):
        best = np.inf
        for y in rows:
            scores, meets = scored[y], shared[y]
            for x in columns:
                if not (scores[x] < best and meets[x] >= least):
                    continue
                free = True
                for i in range(k):
                    near = _apart(y, found[i, 0], ny) <= apart and _apart(x, found[i, 1], nx) <= apart
                    free = free and not near
                if free:
                    best, found[k, 0], found[k, 1] = scores[x], y, x
        if best == np.inf:
            return k
    return len(found)
