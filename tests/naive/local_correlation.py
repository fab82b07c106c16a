"""Correlation under Gaussian windows, window by window."""

import math

import numpy as np


def window(weight, centre, sigma):
    """Weights of all grid points in the window around one of them, cut at 2.6 sigma along each axis."""
    far = max(1, math.floor(2.6 * sigma + 0.5))
    apart = [np.arange(n) - at for n, at in zip(weight.shape, centre, strict=True)]
    shares = [np.where(abs(a) <= far, np.exp(-0.5 * a**2 / sigma**2), 0.0) for a in apart]
    return weight * math.prod(np.meshgrid(*shares, indexing="ij"))


def correlation(fixed, moving, share, floors):
    fixed_mean, moving_mean = np.average(fixed, weights=share), np.average(moving, weights=share)
    f, m = fixed - fixed_mean, moving - moving_mean
    powers = [np.average(part**2, weights=share) + e for part, e in zip((f, m), floors, strict=True)]
    return np.average(f * m, weights=share) / math.sqrt(math.prod(powers))


def value(fixed, moving, weight, floors, sigma, contrast):
    counted = {"any": lambda r: r * r, "same": lambda r: r, "inverted": lambda r: -r}[contrast]
    places = [place for place in np.ndindex(weight.shape) if weight[place] > 0]
    found = [counted(correlation(fixed, moving, window(weight, at, sigma), floors)) for at in places]
    return -np.average(found, weights=[weight[place] for place in places])
