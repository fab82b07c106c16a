"""The (1+1) evolution strategy in plain lists, as the paper and ITK tell it."""

import math


def walk(cost, start, scales, draw, *, radius, growth=1.05, epsilon=1.5e-4, iterations=100):
    """Parents, their values and the matrix norms of each iteration."""
    n = len(start)
    shrink = growth**-0.25
    a = [[radius / scales[r] if r == c else 0.0 for c in range(n)] for r in range(n)]
    parent = list(start)
    best = cost(parent)
    told = []
    for _ in range(iterations):
        f = [draw() for _ in range(n)]
        delta = [0.0] * n
        for r in range(n):
            for c in range(n):
                delta[r] += a[r][c] * f[c]
        child = [p + d for p, d in zip(parent, delta, strict=True)]
        value = cost(child)
        k = shrink
        if value < best:
            best, parent, k = value, child, growth
        square = 0.0
        for row in a:
            for entry in row:
                square += entry * entry
        norm = math.sqrt(square)
        if norm <= epsilon:
            break
        length = 0.0
        for x in f:
            length += x * x
        alpha = (k - 1.0) / length
        for r in range(n):
            for c in range(n):
                a[r][c] += alpha * delta[r] * f[c]
        told.append((list(parent), best, norm))
    return told
