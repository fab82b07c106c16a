"""Normalised gradient fields, point by point, straight from the equations."""

import itertools
import math


def neighbours(place, axis):
    ahead, behind = list(place), list(place)
    ahead[axis] += 1
    behind[axis] -= 1
    return tuple(ahead), tuple(behind)


def points(weight):
    """Places all of whose neighbours have weight."""
    for place in itertools.product(*(range(1, n - 1) for n in weight.shape)):
        around = [at for axis in range(weight.ndim) for at in neighbours(place, axis)]
        if weight[place] > 0 and all(weight[at] > 0 for at in around):
            yield place


def gradient(image, place):
    ends = [neighbours(place, axis) for axis in range(image.ndim)]
    return [(image[ahead] - image[behind]) / 2 for ahead, behind in ends]


def value(fixed, moving, weight, noise):
    places = list(points(weight))
    mass = sum(weight[place] for place in places)
    edges = [
        noise * sum(weight[place] * math.hypot(*gradient(image, place)) for place in places) / mass
        for image in (fixed, moving)
    ]
    total = 0.0
    for place in places:
        one, other = gradient(fixed, place), gradient(moving, place)
        lengths = [math.hypot(*g, edge) for g, edge in zip((one, other), edges, strict=True)]
        cosine = sum(a * b for a, b in zip(one, other, strict=True)) / (lengths[0] * lengths[1])
        total += weight[place] * (1 - cosine**2)
    return total / mass
