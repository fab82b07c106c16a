"""Lanczos interpolation."""

from itertools import product
from math import prod
from typing import final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from regframe import Interpolator

Floats = NDArray[np.float64]


@final
class Lanczos(Interpolator):
    """A sinc windowed by the middle of a wider one: sharp, with little ringing, and no prefilter.

    C. Duchon, "Lanczos filtering in one and two dimensions", J. Applied Meteorology 18(8), 1979. Weights
    are divided by their sum, so that a constant image stays constant, and the rim's values go on beyond the
    image. Unlike `windowed-sinc`, ITK's, it reaches as few pixels as wanted. Slopes are central differences.
    """

    radius: int = Field(3, ge=1, le=8, description="Pixels to each side; a value takes (2 radius) ** dim.")

    def sample(self, coefficients: Floats, indices: Floats) -> Floats:
        """Values at (n, dim) indices, array order."""
        base = np.floor(indices).astype(np.int64)
        taps = [base + shift for shift in range(1 - self.radius, self.radius + 1)]
        away = np.array([indices - tap for tap in taps])
        weights = np.sinc(away) * np.sinc(away / self.radius)
        weights /= weights.sum(axis=0)
        places = np.clip(taps, 0, np.array(coefficients.shape) - 1)
        total = np.zeros(len(indices))
        for chosen in product(range(len(taps)), repeat=indices.shape[1]):
            at = tuple(places[tap, :, axis] for axis, tap in enumerate(chosen))
            total += coefficients[at] * prod(weights[tap, :, axis] for axis, tap in enumerate(chosen))
        return total
