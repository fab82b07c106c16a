"""Deriche's recursive Gaussian, line by line, from the formulas."""

import numpy as np

L1, W1, L2, W2 = -1.3932, 0.6681, -1.3732, 2.0787
WAVES = [
    (1.3530, 1.8151, -0.3531, 0.0902),
    (-0.6724, -3.4327, 0.6724, 0.6100),
    (-1.3563, 5.2318, 0.3446, -2.2355),
]


def sums(weights, first):
    return [sum((k + first) ** power * w for k, w in enumerate(weights)) for power in range(3)]


def numerator(sigma, order):
    a1, b1, a2, b2 = WAVES[order]
    e1, e2 = np.exp(L1 / sigma), np.exp(L2 / sigma)
    c1, c2, s1, s2 = np.cos(W1 / sigma), np.cos(W2 / sigma), np.sin(W1 / sigma), np.sin(W2 / sigma)
    return [
        a1 + a2,
        e2 * (b2 * s2 - (a2 + 2 * a1) * c2) + e1 * (b1 * s1 - (a1 + 2 * a2) * c1),
        2 * e1 * e2 * ((a1 + a2) * c1 * c2 - b1 * c2 * s1 - b2 * c1 * s2) + a2 * e1**2 + a1 * e2**2,
        e2 * e1**2 * (b2 * s2 - a2 * c2) + e1 * e2**2 * (b1 * s1 - a1 * c1),
    ]


def weights(sigma, order):
    e1, e2 = np.exp(L1 / sigma), np.exp(L2 / sigma)
    c1, c2 = np.cos(W1 / sigma), np.cos(W2 / sigma)
    d = [
        -2 * (e2 * c2 + e1 * c1),
        4 * c1 * c2 * e1 * e2 + e1**2 + e2**2,
        -2 * c1 * e1 * e2**2 - 2 * c2 * e2 * e1**2,
        e1**2 * e2**2,
    ]
    sd, dd, ed = sums([1.0, *d], 0)
    n = numerator(sigma, order)
    if order == 2:
        n0 = numerator(sigma, 0)
        beta = -(2 * sum(n) - sd * n[0]) / (2 * sum(n0) - sd * n0[0])
        n = [x + beta * y for x, y in zip(n, n0, strict=True)]
    sn, dn, en = sums(n, 0)
    norm = [
        2 * sn / sd - n[0],
        2 * (sn * dd - dn * sd) / sd**2,
        (en * sd**2 - ed * sn * sd - 2 * dn * dd * sd + 2 * dd**2 * sn) / sd**3,
    ][order]
    return [x / norm for x in n], d


def filter_line(x, sigma, order=0):
    """The line filtered, float64."""
    n, d = weights(sigma, order)
    sign = -1 if order == 1 else 1
    m = [sign * (n[k] - d[k - 1] * n[0]) for k in (1, 2, 3)] + [-sign * d[3] * n[0]]
    size, total = len(x), 1 + sum(d)
    y, z = {}, {}
    for k in range(1, 5):
        y[-k], z[size - 1 + k] = x[0] * sum(n) / total, x[-1] * sum(m) / total
    for i in range(size):
        y[i] = sum(n[k] * x[max(i - k, 0)] for k in range(4)) - sum(d[k] * y[i - k - 1] for k in range(4))
    for i in reversed(range(size)):
        ahead = sum(m[k] * x[min(i + k + 1, size - 1)] for k in range(4))
        z[i] = ahead - sum(d[k] * z[i + k + 1] for k in range(4))
    return np.array([y[i] + z[i] for i in range(size)])


def smooth(values, sigmas):
    """Every axis in ITK's order, rounded to float32 after each."""
    out = np.asarray(values, dtype=np.float64)
    for axis in (0, *range(out.ndim - 1, 0, -1)):
        out = np.apply_along_axis(filter_line, axis, out, sigmas[axis]).astype(np.float32).astype(np.float64)
    return out
