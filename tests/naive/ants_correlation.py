"""Squared correlation in windows, window by window."""

import numpy as np


def value(fixed, moving, weight, radius):
    """Volumes in; minus the weighted mean over the centres."""
    total = 0.0
    for centre in np.argwhere(weight > 0):
        window = tuple(slice(max(i - radius, 0), i + radius + 1) for i in centre)
        w, f, m = (volume[window].ravel() for volume in (weight, fixed, moving))
        f, m = f - np.average(f, weights=w), m - np.average(m, weights=w)
        powers = (w * f * f).sum() * (w * m * m).sum()
        score = (w * f * m).sum() ** 2 / powers if powers > np.finfo(float).eps else 1.0
        total += weight[tuple(centre)] * score
    return -total / weight.sum()
