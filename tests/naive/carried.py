"""Correlation of channels carried along by a map, point by point in double precision."""

import numpy as np


def met(moving, index_map, shape):
    """Bilinear values, their slopes by y and x, and whether they exist, of (my, mx, 4) at mapped indices."""
    ny, nx = shape
    y, x = (
        row[0] * np.arange(ny)[:, None] + row[1] * np.arange(nx)[None] + row[2]
        for row in np.asarray(index_map)
    )
    my, mx = moving.shape[:2]
    inside = (y >= 0) & (x >= 0) & (y < my - 1) & (x < mx - 1)
    i, j = (np.where(inside, np.floor(at), 0).astype(int) for at in (y, x))
    ty, tx = (np.where(inside, at - near, 0.0)[..., None] for at, near in ((y, i), (x, j)))
    a, b, c, d = (moving[i + p, j + q].astype(float) for p, q in ((0, 0), (0, 1), (1, 0), (1, 1)))
    values = (1 - ty) * ((1 - tx) * a + tx * b) + ty * ((1 - tx) * c + tx * d)
    down, along = (1 - tx) * (c - a) + tx * (d - b), (1 - ty) * (b - a) + ty * (d - c)
    return values, down, along, inside


def value_and_slope(fixed, moving, index_map):
    """Minus the correlation of three channels under both weights, and its slope by the map."""
    m, down, along, inside = met(moving, index_map, fixed.shape[:2])
    f = fixed.astype(float)
    w = (f[..., 3] * m[..., 3] * inside)[..., None]
    f, m, down, along = (one[..., :3] for one in (f, m, down, along))
    f, m = (one - (w * one).sum(axis=(0, 1)) / w.sum() for one in (f, m))
    both, below, above = (float((w * one).sum()) for one in (f * m, f * f, m * m))
    force = w * (both / above * m - f) / np.sqrt(below * above)
    pushes = [(force * slope).sum(axis=2) for slope in (down, along)]
    rows, columns = np.indices(fixed.shape[:2])
    slope = [[(push * lever).sum() for lever in (rows, columns, 1.0)] for push in pushes]
    return -both / np.sqrt(below * above), np.array(slope)


def turned(upright, index_map, shape, angle):
    """Weight, weighted power about the means, and weighted channels, seen from a grid turned by an angle."""
    weight = upright[..., 3].astype(float)
    means = (weight[..., None] * upright[..., :3]).sum(axis=(0, 1)) / weight.sum()
    m, _, _, inside = met(upright, index_map, shape)
    w, about = m[..., 3] * inside, m[..., :3] - means
    direction = (about[..., 1] + 1j * about[..., 2]) * np.exp(-2j * angle)
    return np.stack(
        [w, w * (about**2).sum(axis=2), w * about[..., 0], w * direction.real, w * direction.imag]
    )
