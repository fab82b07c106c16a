"""Mutual information at every whole translation at once, by Fourier transforms.

Öfverstedt, Lindblad and Sladoje, "Fast computation of mutual information in the frequency domain with
applications to global multimodal image alignment", Pattern Recognition Letters 159, 2022 (preprint 2021):
each image is cut into a few classes of intensity; the joint histogram at a translation is the correlation
of the classes' masks there.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regframe.kernels.fourier import Spectrum, correlate, spectra
from regframe.types import Values, Volume

FEW = 1e-3
"""Points of a joint class below which it is taken for the rounding noise of single precision."""
CLASSES = 8
"""Of intensity, each of about equally many points."""


def scorer(values: Volume, weight: Volume, lattice: Sequence[int]) -> "Scorer":
    """From a moving image and its weights to minus the information, and the joint weight, of a fixed image.

    Parameters
    ----------
    values, weight : arrays of one shape
        The fixed image.
    lattice : tuple of int
        Shape of the translations.
    """
    return Scorer(spectra(classes(values, weight, edges(values, weight, CLASSES)), lattice), tuple(lattice))


class Scorer(NamedTuple):
    """The classes of a fixed image, ready to meet others."""

    fixed: Spectrum
    lattice: tuple[int, ...]

    def __call__(self, moving: Volume, weight: Volume) -> tuple[Volume, Volume]:
        """Minus the information, and the joint weight, at every translation."""
        met = classes(moving, weight, edges(moving, weight, CLASSES))
        found, shared = information(self.fixed, met, self.lattice)
        return -np.asarray(found, np.float64), np.asarray(shared, np.float64)


def classes(values: Volume, weight: Volume, edges: Values) -> Volume:
    """The weight of each class of intensities, (classes, *shape); class k lies between edges k - 1 and k."""
    label = np.searchsorted(edges, values, side="right")
    return np.stack([weight * (label == k) for k in range(len(edges) + 1)])


def edges(values: Volume, weight: Volume, count: int) -> Values:
    """Edges between `count` classes of about equally many points; fewer where values repeat."""
    counted = values[weight > 0.0]
    if not counted.size:
        return np.empty(0)
    return np.unique(np.quantile(counted, np.arange(1, count) / count))


def information(
    fixed: Spectrum, moving: Volume, shape: Sequence[int]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Mutual information in nats, and the sum of joint weights, at every translation of the lattice.

    Parameters
    ----------
    fixed : (classes, *lattice) spectrum
        Of the fixed image's classes.
    moving : (classes, *image) array
        The moving image's classes.
    shape : tuple of int
        The lattice's.
    """
    above = spectra(moving, shape)
    rows = np.zeros(tuple(shape), np.float32)
    columns = np.zeros((len(moving), *shape), np.float32)
    joint = np.zeros(tuple(shape), np.float32)
    for one in fixed:
        counts = np.maximum(correlate(one[None], above[:, None], shape), 0.0)
        joint += _log_sum(counts)
        rows += _log_sum(counts.sum(axis=0)[None])
        columns += counts
    mass = columns.sum(axis=0)
    total = np.maximum(mass, FEW)
    found = (joint - rows - _log_sum(columns)) / total + np.log(total)
    return np.asarray(found, np.float32), mass


def _log_sum(counts: NDArray[np.float32]) -> NDArray[np.float32]:
    """Sum over the first axis of n ln n."""
    return np.asarray((counts * np.log(np.maximum(counts, FEW))).sum(axis=0), np.float32)
