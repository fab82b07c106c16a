"""Radial distortion of a lens by the division model: straight = c + (seen - c) / (1 + k1 r^2 + k2 r^4)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from regframe.geometry import Grid
from regframe.types import Params


@dataclass(frozen=True, eq=False)
class Lens:
    """What a lens does to an ideal (pinhole) image.

    Radii are in half diagonals of the image, so that coefficients mean the same for every frame size: a
    coefficient is about the share by which it moves a corner. Negative ones are barrel distortion.

    Parameters
    ----------
    centre : (2,) float64
        Of distortion, physical.
    radius : float
        The unit of radii, mm.
    coefficients : (0, 1 or 2) float64
    """

    centre: Params
    radius: float
    coefficients: Params

    @classmethod
    def of_image(cls, grid: Grid, coefficients: Params) -> "Lens":
        """The lens whose axis meets the image in its middle."""
        return cls(grid.centre, grid.radius, coefficients)

    @cached_property
    def limit(self) -> float:
        """Square of the seen radius up to which the ideal one rises, in half diagonals squared."""
        first, second = self.pair
        roots = (_first_root(first, second), _first_root(-first, -3 * second))
        return min(roots) * (1 - 1e-9)

    @property
    def pair(self) -> tuple[float, float]:
        """k1 and k2, 0 where the lens has fewer."""
        first, second = (*map(float, self.coefficients), 0.0, 0.0)[:2]
        return first, second


def _first_root(first: float, second: float) -> float:
    """Smallest z > 0 with 1 + first z + second z^2 = 0, or infinity."""
    inner = first * first - 4 * second
    if inner < 0:
        return np.inf
    # The form with the root below: no difference of near numbers for a small `second`.
    low = max(-first + np.sqrt(inner), -first - np.sqrt(inner))
    return 2.0 / low if low > 1e-9 else np.inf
