"""The few lowest places of a table that goes round, one look at every entry a place."""

import numpy as np


def lowest(scored, shared, within, least, most, apart):
    """Row and column of the lowest scores, none near one before it."""
    rows, columns = within
    allowed = np.zeros(scored.shape, bool)
    allowed[np.ix_(rows, columns)] = True
    left = np.where(allowed & (shared >= least), scored, np.inf)
    found = []
    while len(found) < most and np.isfinite(left.min()):
        y, x = np.unravel_index(left.argmin(), left.shape)
        found.append((int(y), int(x)))
        for at in np.ndindex(left.shape):
            steps = [abs(a - b) for a, b in zip(at, (y, x), strict=True)]
            if all(min(s, n - s) <= apart for s, n in zip(steps, left.shape, strict=True)):
                left[at] = np.inf
    return found
