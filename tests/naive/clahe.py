"""Contrast limited equalisation of a plane, pixel by pixel."""

import numpy as np


def clahe(values, tiles, clip_limit, bins):
    """Zuiderveld's method; tiles must divide the plane evenly."""
    low, high = values.min(), values.max()
    height, width = values.shape[0] // tiles, values.shape[1] // tiles
    rows = [values[i * height : (i + 1) * height] for i in range(tiles)]
    pieces = [[row[:, j * width : (j + 1) * width] for j in range(tiles)] for row in rows]
    shares = [[_table(piece, low, high, clip_limit, bins) for piece in row] for row in pieces]
    result = np.empty(values.shape)
    for y, x in np.ndindex(values.shape):
        row = min(max((y + 0.5) / height - 0.5, 0), tiles - 1)
        column = min(max((x + 0.5) / width - 0.5, 0), tiles - 1)
        i, j = int(row), int(column)
        below, right = min(i + 1, tiles - 1), min(j + 1, tiles - 1)
        level = _level(values[y, x], low, high, bins)
        upper = (1 - (column - j)) * shares[i][j][level] + (column - j) * shares[i][right][level]
        lower = (1 - (column - j)) * shares[below][j][level] + (column - j) * shares[below][right][level]
        result[y, x] = low + (high - low) * ((1 - (row - i)) * upper + (row - i) * lower)
    return result


def _level(value, low, high, bins):
    return min(int((value - low) / (high - low) * bins), bins - 1)


def _table(tile, low, high, clip_limit, bins):
    counts = [0] * bins
    for value in tile.flat:
        counts[_level(value, low, high, bins)] += 1
    limit = max(clip_limit * tile.size / bins, 1)
    above = sum(max(count - limit, 0) for count in counts)
    table, total = [], 0.0
    for count in counts:
        total += min(count, limit) + above / bins
        table.append(total / tile.size)
    return table
