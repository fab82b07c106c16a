"""Directions of gradients: central differences, their agreement with others, and the way back.

Volumes are 3-D here, a 2-D image is one slice and has no slope across it. Gradients are (3, nz, ny, nx), z
first. Sums are kept row by row, so that their order does not depend on the threads.
"""

import math

from regframe.kernels.jit import kernel
from regframe.types import Matrix, Volume


@kernel
def differences(
    first: int, last: int, values: Volume, weight: Volume, gradient: Volume, whole: Volume, sums: Matrix
) -> None:
    """Of rows `first` to `last`: gradients, weights amid weights, and the sums of w |g| and of w."""
    depth, height, width = values.shape
    flat = depth == 1
    for row in range(first, last):
        z, y = row // height, row % height
        gradient[:, z, y] = 0.0
        whole[z, y] = 0.0
        sums[row] = 0.0
        if y == 0 or y == height - 1 or (not flat and (z == 0 or z == depth - 1)):
            continue
        below, above = (z, z) if flat else (z - 1, z + 1)
        for x in range(1, width - 1):
            own = weight[z, y, x]
            beside = weight[z, y, x - 1] > 0.0 and weight[z, y, x + 1] > 0.0
            beside = beside and weight[z, y - 1, x] > 0.0 and weight[z, y + 1, x] > 0.0
            if own == 0.0 or not (beside and weight[below, y, x] > 0.0 and weight[above, y, x] > 0.0):
                continue
            along_z = 0.5 * (values[above, y, x] - values[below, y, x])
            along_y = 0.5 * (values[z, y + 1, x] - values[z, y - 1, x])
            along_x = 0.5 * (values[z, y, x + 1] - values[z, y, x - 1])
            gradient[0, z, y, x], gradient[1, z, y, x], gradient[2, z, y, x] = along_z, along_y, along_x
            whole[z, y, x] = own
            sums[row, 0] += own * math.sqrt(along_z * along_z + along_y * along_y + along_x * along_x)
            sums[row, 1] += own


@kernel
def agreement(
    first: int,
    last: int,
    gradient: Volume,
    fixed: Volume,
    whole: Volume,
    edge: float,
    cosine: Volume,
    sums: Matrix,
) -> None:
    """Of rows `first` to `last`: cosines c with the fixed directions, sums of w c^2 and of w c^2 / q^2.

    `edge` is squared: q^2 = |g|^2 + edge.
    """
    height, width = gradient.shape[2:]
    for row in range(first, last):
        z, y = row // height, row % height
        total = bent = 0.0
        for x in range(width):
            g_z, g_y, g_x = gradient[0, z, y, x], gradient[1, z, y, x], gradient[2, z, y, x]
            squared = g_z * g_z + g_y * g_y + g_x * g_x + edge
            along = fixed[0, z, y, x] * g_z + fixed[1, z, y, x] * g_y + fixed[2, z, y, x] * g_x
            here = along / math.sqrt(squared)
            cosine[z, y, x] = here
            share = whole[z, y, x] * here * here
            total += share
            bent += share / squared
        sums[row, 0], sums[row, 1] = total, bent


@kernel
def forces(
    first: int,
    last: int,
    gradient: Volume,
    fixed: Volume,
    whole: Volume,
    edge: float,
    cosine: Volume,
    share: float,
    steep: float,
    out: Volume,
) -> None:
    """Slopes by gradient: share w c (nf / q - c g / q^2), and steep w g / |g| by the mean length."""
    height, width = gradient.shape[2:]
    for row in range(first, last):
        z, y = row // height, row % height
        for x in range(width):
            g_z, g_y, g_x = gradient[0, z, y, x], gradient[1, z, y, x], gradient[2, z, y, x]
            length = g_z * g_z + g_y * g_y + g_x * g_x
            squared, own, here = length + edge, whole[z, y, x], cosine[z, y, x]
            towards = share * own * here / math.sqrt(squared)
            along = -share * own * here * here / squared
            if length > 0.0:
                along += steep * own / math.sqrt(length)
            out[0, z, y, x] = towards * fixed[0, z, y, x] + along * g_z
            out[1, z, y, x] = towards * fixed[1, z, y, x] + along * g_y
            out[2, z, y, x] = towards * fixed[2, z, y, x] + along * g_x


@kernel
def back(first: int, last: int, felt: Volume, slopes: Volume) -> None:
    """Rows `first` to `last` of the slopes by intensity, of a number with slopes `felt` by gradient."""
    _, depth, height, width = felt.shape
    for row in range(first, last):
        z, y = row // height, row % height
        for x in range(width):
            total = 0.0
            if depth > 1:
                total += felt[0, z - 1, y, x] if z > 0 else 0.0
                total -= felt[0, z + 1, y, x] if z < depth - 1 else 0.0
            total += felt[1, z, y - 1, x] if y > 0 else 0.0
            total -= felt[1, z, y + 1, x] if y < height - 1 else 0.0
            total += felt[2, z, y, x - 1] if x > 0 else 0.0
            total -= felt[2, z, y, x + 1] if x < width - 1 else 0.0
            slopes[z, y, x] = 0.5 * total
