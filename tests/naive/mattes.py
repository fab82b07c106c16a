"""Mattes mutual information, sample by sample, straight from the equations."""

import math


def window(u):
    u = abs(u)
    if u < 1:
        return (4 - 6 * u**2 + 3 * u**3) / 6
    return (2 - u) ** 3 / 6 if u < 2 else 0.0


def joint(fixed, moving, weight, fixed_range, moving_range, bins):
    """Joint probability by fixed bin and moving bin."""
    counts = [[0.0] * bins for _ in range(bins)]
    (fixed_low, fixed_high), (low, high) = fixed_range, moving_range
    fixed_width, width = (fixed_high - fixed_low) / (bins - 4), (high - low) / (bins - 4)
    for f, m, w in zip(fixed, moving, weight, strict=True):
        if w == 0 or not low <= m <= high:
            continue
        row = min(max(int(f / fixed_width - (fixed_low / fixed_width - 2)), 2), bins - 3)
        place = m / width - (low / width - 2)
        for column in range(bins):
            counts[row][column] += w * window(column - place)
    total = sum(map(sum, counts))
    return [[count / total for count in row] for row in counts]


def value(fixed, moving, weight, fixed_range, moving_range, bins):
    """Negative mutual information in nats."""
    shares = joint(fixed, moving, weight, fixed_range, moving_range, bins)
    rows, columns = [sum(row) for row in shares], [sum(column) for column in zip(*shares, strict=True)]
    return -sum(
        share * math.log(share / (rows[k] * columns[column]))
        for k, row in enumerate(shares)
        for column, share in enumerate(row)
        if share > 1e-15
    )
