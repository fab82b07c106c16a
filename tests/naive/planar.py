"""Points through two lenses and a homography, one at a time, radii by bisection."""

import math


def undistorted(point, centre, radius, coefficients):
    square = sum((p - c) ** 2 for p, c in zip(point, centre, strict=True)) / radius**2
    division = 1 + sum(k * square ** (i + 1) for i, k in enumerate(coefficients))
    return [c + (p - c) / division for p, c in zip(point, centre, strict=True)]


def distorted(point, centre, radius, coefficients, edge):
    """The place within `edge` radii of the centre whose undistorted one is the point."""
    ideal = math.dist(point, centre)
    if ideal == 0:
        return list(point)
    low, high = 0.0, edge * radius
    for _ in range(200):
        middle = (low + high) / 2
        straight = undistorted([centre[0] + middle, centre[1]], centre, radius, coefficients)[0] - centre[0]
        low, high = (middle, high) if straight < ideal else (low, middle)
    return [c + (p - c) * low / ideal for p, c in zip(point, centre, strict=True)]


def projected(point, whole):
    x, y, depth = (row[0] * point[0] + row[1] * point[1] + row[2] for row in whole)
    return [x / depth, y / depth]
