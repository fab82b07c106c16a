"""Between (n, dim) arrays of the interface and the 3-D arrays of the kernels."""

from collections.abc import Callable

import numpy as np

from regframe.geometry import AffineMap
from regframe.interpolators.base import Samples
from regframe.kernels.sharing import BLOCKS, share
from regframe.types import Bins, Indices, Matrix, Values, Volume

RUN = 256  # stored samples a row; the kernels' own constant


def as_3d(volume: Volume) -> Volume:
    """A 2-D volume as one slice."""
    return volume[None] if volume.ndim == 2 else volume


def padded(indices: Indices) -> Indices:
    """(n, 2) indices with a leading zero axis."""
    if indices.shape[1] == 3:
        return np.ascontiguousarray(indices)
    return np.ascontiguousarray(np.column_stack([np.zeros(len(indices)), indices]))


def kernel_matrix(index_map: AffineMap | None, dim: int) -> Matrix:
    """(3, 4) matrix of an index map."""
    whole = np.zeros((3, 4))
    whole[:, :3] = np.eye(3)
    if index_map is not None:
        whole[3 - dim :, 3 - dim : 3] = index_map.matrix
        whole[3 - dim :, 3] = index_map.offset
    return whole


def kernel_samples(samples: Samples) -> tuple[Bins, Indices, int]:
    """Grid shape (3,), stored indices (n, 3) or (0, 3), and the number of rows to share out."""
    grid = np.array((1, *samples.shape)[-3:], np.int64)
    if samples.indices is None:
        return grid, np.empty((0, 3)), int(grid[0] * grid[1])
    return grid, padded(samples.indices), -(-len(samples) // RUN)


def resampled(
    kernel: Callable[..., object],
    volume: Volume,
    setting: int | Values,
    samples: Samples,
    index_map: AffineMap | None,
) -> tuple[Values, Values]:
    """Run a kernel's `resample` with its order, window or widths: values and inside weights."""
    grid, indices, rows = kernel_samples(samples)
    values, weights = np.empty(len(samples)), np.empty(len(samples))
    matrix = kernel_matrix(index_map, volume.ndim)
    share(kernel, rows, as_3d(volume), setting, grid, indices, matrix, values, weights)
    return values, weights


def summed(partial: Volume, dim: int) -> Matrix:
    """(dim, dim + 1) from the blocks' (BLOCKS, 3, 4) sums, added in order."""
    total = np.zeros((3, 4))
    for block in range(BLOCKS):
        total += partial[block]
    return np.ascontiguousarray(total[3 - dim :, 3 - dim :])
