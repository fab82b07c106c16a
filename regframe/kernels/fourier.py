"""Sums of products at every whole translation at once, by fast Fourier transforms.

Single precision: the sums serve to choose places that are measured again. A transform runs on the thread
that asks for it, so the bits do not depend on the number of threads.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from regframe.kernels.jit import kernel
from regframe.types import Scores, Volume

Spectrum = NDArray[np.complex64]
U = np.uint64


BLOCK = 4
"""Translations from one to the next where what varies slowly is summed."""


def lattice(lengths: Iterable[float]) -> tuple[int, ...]:
    """The next lengths that transforms are quick for, multiples of `BLOCK`.

    Examples
    --------
    >>> lattice((97, 101))
    (100, 108)
    """
    from scipy.fft import next_fast_len

    return tuple(BLOCK * int(next_fast_len(int(np.ceil(length / BLOCK)), real=True)) for length in lengths)


def shortened(planes: NDArray[np.float32]) -> NDArray[np.float32]:
    """Means over blocks of `BLOCK` points along y and x, zeros beyond the border."""
    *before, ny, nx = planes.shape
    out = np.zeros((*before, -(-ny // BLOCK), -(-nx // BLOCK)), np.float32)
    _shorten(planes.reshape(-1, ny, nx), BLOCK, out.reshape(-1, *out.shape[-2:]))
    return out


def lengthened(planes: NDArray[np.float32]) -> NDArray[np.float32]:
    """Between every `BLOCK`-th translation along y and x, linearly; the lattice goes round."""
    *before, ny, nx = planes.shape
    out = np.empty((*before, BLOCK * ny, BLOCK * nx), np.float32)
    _lengthen(planes.reshape(-1, ny, nx), BLOCK, out.reshape(-1, *out.shape[-2:]))
    return out


@kernel
def _shorten(planes: Volume, block: int, out: Volume) -> None:
    count, ny, nx = planes.shape
    for p in range(count):
        for y in range(ny):
            line, here = planes[p, y], out[p, y // block]
            for x in range(nx):
                here[x // block] += line[x]
    out /= np.float32(block * block)


@kernel
def _lengthen(planes: Volume, block: int, out: Volume) -> None:
    count, ny, nx = planes.shape
    line = np.empty(nx + 1, planes.dtype)
    for p in range(count):
        for y in range(block * ny):
            above, below, t = planes[p, y // block], planes[p, (y // block + 1) % ny], (y % block) / block
            for x in range(nx):
                line[x] = above[x] + t * (below[x] - above[x])
            line[nx] = line[0]
            for x in range(nx):
                step = (line[x + 1] - line[x]) / block
                for k in range(block):
                    out[p, y, block * x + k] = line[x] + k * step


def spectra(stack: Scores, shape: Sequence[int]) -> Spectrum:
    """Spectrum of each image of a stack, zeros added up to `shape`.

    Parameters
    ----------
    stack : (..., *image) array
    shape : tuple of int
        Of the lattice of translations, at least the image's along each axis.
    """
    from scipy.fft import fft, rfft

    found: Spectrum = rfft(np.asarray(stack, np.float32), shape[-1], workers=1)
    # Axis by axis: rows that are zeros alone are spared along the first.
    for axis in range(2, len(shape) + 1):
        if shape[-axis] > 1:
            found = fft(found, shape[-axis], axis=-axis, overwrite_x=True, workers=1)
    return found


def correlate(fixed: Spectrum, moving: Spectrum, shape: Sequence[int]) -> NDArray[np.float32]:
    """Sums over x and the first axis of ``fixed(x) moving(x + t)`` at every t of the lattice.

    Parameters
    ----------
    fixed : (c, *lattice) spectra
    moving : (..., c, *lattice) spectra
    shape : tuple of int
        The lattice's.

    Returns
    -------
    (..., *shape) float32
        Negative translations stand at the end, as in every discrete transform.
    """
    from scipy.fft import irfftn

    (channels, *bins), size = fixed.shape, fixed[0].size
    product = np.empty((*moving.shape[: -1 - len(bins)], *bins), np.complex64)
    above = moving.reshape(-1, channels, size)
    _multiply(fixed.reshape(channels, size), above, product.reshape(-1, size))
    found: NDArray[np.float32] = irfftn(product, tuple(shape), axes=tuple(range(-len(shape), 0)), workers=1)
    return found


@kernel
def _multiply(fixed: Spectrum, moving: Spectrum, out: Spectrum) -> None:
    """Sums of conjugate products over channels: of (c, n) with (k, c, n) into (k, n)."""
    channels, count = fixed.shape
    for k in range(len(out)):
        line = out[k]
        line[:] = np.complex64(0.0)
        for c in range(channels):
            below, above = fixed[c], moving[k, c]
            for i in range(U(count)):
                line[i] += below[i].conjugate() * above[i]
