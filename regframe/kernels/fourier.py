"""Sums of products at every whole translation at once, by fast Fourier transforms.

Single precision: the sums serve to choose places that are measured again. A transform runs on the thread
that asks for it, so the bits do not depend on the number of threads.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

Spectrum = NDArray[np.complex64]
Stack = NDArray[np.float64] | NDArray[np.float32]


def lattice(lengths: Iterable[float]) -> tuple[int, ...]:
    """The next lengths that transforms are quick for.

    Examples
    --------
    >>> lattice((97, 101))
    (100, 108)
    """
    from scipy.fft import next_fast_len

    return tuple(int(next_fast_len(int(np.ceil(length)), real=True)) for length in lengths)


def spectra(stack: Stack, shape: Sequence[int]) -> Spectrum:
    """Spectrum of each image of a stack, zeros added up to `shape`.

    Parameters
    ----------
    stack : (..., *image) array
    shape : tuple of int
        Of the lattice of translations, at least the image's along each axis.
    """
    from scipy.fft import rfftn

    axes = tuple(range(-len(shape), 0))
    found: Spectrum = rfftn(np.asarray(stack, np.float32), tuple(shape), axes=axes, workers=1)
    return found


def correlate(fixed: Spectrum, moving: Spectrum, shape: Sequence[int]) -> NDArray[np.float32]:
    """Sums over x and the first axis of ``fixed(x) moving(x + t)`` at every t of the lattice.

    Parameters
    ----------
    fixed, moving : (..., c, *lattice) spectra
    shape : tuple of int
        The lattice's.

    Returns
    -------
    (..., *shape) float32
        Negative translations stand at the end, as in every discrete transform.
    """
    from scipy.fft import irfftn

    product = (fixed.conj() * moving).sum(axis=-1 - len(shape))
    found: NDArray[np.float32] = irfftn(product, tuple(shape), axes=tuple(range(-len(shape), 0)), workers=1)
    return found
