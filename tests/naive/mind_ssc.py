"""Self-similarity descriptors, point by point, straight from their definition."""

import itertools
import math

import numpy as np


def neighbours(dim, reach):
    """Pairs of offsets that stand at a right angle."""
    around = [sign * reach * axis for axis in np.eye(dim, dtype=int) for sign in (-1, 1)]
    return [(a.tolist(), b.tolist()) for a, b in itertools.combinations(around, 2) if a @ b == 0]


def moved(place, *offsets):
    return tuple(map(sum, zip(place, *offsets, strict=True)))


def window(dim, sigma):
    """Offsets and Gaussian weights of a patch, cut at 2.6 sigma."""
    far = max(1, math.floor(2.6 * sigma + 0.5))
    offsets = list(itertools.product(range(-far, far + 1), repeat=dim))
    shares = [math.exp(-0.5 * sum(o * o for o in offset) / sigma**2) for offset in offsets]
    return [(offset, share / sum(shares)) for offset, share in zip(offsets, shares, strict=True)]


def read(image, place):
    """Value at a place, None outside."""
    inside = all(0 <= at < n for at, n in zip(place, image.shape, strict=True))
    return image[place] if inside else None


def descriptor(image, weight, place, patch, reach, floor):
    """A number a channel, or None where a patch has no weight."""
    distances = []
    for one, other in neighbours(image.ndim, reach):
        total = mass = 0.0
        for offset, share in patch:
            a, b = moved(place, offset, one), moved(place, offset, other)
            if read(image, a) is None or read(image, b) is None:
                continue
            both = share * read(weight, a) * read(weight, b)
            total += both * (read(image, a) - read(image, b)) ** 2
            mass += both
        if mass <= 1e-6:
            return None
        distances.append(total / mass)
    distances = np.array(distances) - min(distances)
    return np.exp(-distances / max(distances.mean(), floor))


def value(fixed, moving, weight, floors, sigma, reach):
    patch = window(weight.ndim, sigma)
    total = mass = 0.0
    for place in np.ndindex(weight.shape):
        if weight[place] == 0:
            continue
        one, other = (
            descriptor(image, weight, place, patch, reach, floor)
            for image, floor in zip((fixed, moving), floors, strict=True)
        )
        if one is not None and other is not None:
            total += weight[place] * np.mean((one - other) ** 2)
            mass += weight[place]
    return total / mass
