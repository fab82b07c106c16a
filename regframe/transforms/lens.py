"""Radial distortion of a lens by the division model: straight = c + (seen - c) / (1 + k1 r^2 + k2 r^4)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from regframe.geometry import Grid
from regframe.transforms.homography import FAR
from regframe.types import Mask, Params, Points, Values

ROUNDS = 60
"""Most rounds of the search for a radius: bisection alone would reach the last bit in these."""


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

    def undistort(self, points: Points) -> Points:
        """Ideal places of (n, 2) seen points; those beyond the model's range go to `FAR`."""
        arms = points - self.centre
        square = self._square(arms)
        inside = square < self.limit
        straight = arms / np.where(inside, self._division(square), 1.0)[:, None] + self.centre
        straight[~inside] = FAR
        return np.asarray(straight)

    def distort(self, points: Points) -> Points:
        """Seen places of (n, 2) ideal points; those that no place of the model's range shows go to `FAR`."""
        arms = points - self.centre
        ideal = np.sqrt(self._square(arms))
        seen, inside = self._seen(ideal)
        bent = arms * self._division(seen**2)[:, None] + self.centre
        bent[~inside] = FAR
        return np.asarray(bent)

    def undistorted_gradient(self, points: Points, forces: Points) -> tuple[Params, Points]:
        """Forces on `undistort`: their sum by coefficient, (k,), and pulled back to the points, (n, 2)."""
        arms = points - self.centre
        square = self._square(arms)
        inside = square < self.limit
        arms, forces = np.where(inside[:, None], arms, 0.0), np.where(inside[:, None], forces, 0.0)
        square = self._square(arms)
        division, rise = self._division(square), self._rise(square)
        along = (arms * forces).sum(axis=1) / division**2
        pulled = forces / division[:, None] - arms * (2 * along * rise / self.radius**2)[:, None]
        return np.asarray(-self._powers(square) @ along), np.asarray(pulled)

    def distorted_gradient(self, points: Points, forces: Points) -> tuple[Params, Points]:
        """Forces on `distort`: their sum by coefficient, (k,), and pulled back to the points, (n, 2)."""
        arms = points - self.centre
        seen, inside = self._seen(np.sqrt(self._square(arms)))
        square = np.where(inside, seen**2, 0.0)
        forces = np.where(inside[:, None], forces, 0.0)
        division, rise = self._division(square), self._rise(square)
        bent = np.where(inside[:, None], arms, 0.0) * division[:, None]
        # The derivative of `undistort` there is a (1 - b y y'), symmetric; this is its inverse, times forces.
        b = 2 * rise / (self.radius**2 * division)
        along = (bent * forces).sum(axis=1)
        grip = division * b * along / (1.0 - 2 * rise * square / division)
        pulled = forces * division[:, None] + bent * grip[:, None]
        turned = (bent * pulled).sum(axis=1) / division**2
        return np.asarray(self._powers(square) @ turned), np.asarray(pulled)

    @cached_property
    def limit(self) -> float:
        """Square of the seen radius up to which the ideal one rises, in half diagonals squared."""
        first, second = self._pair
        roots = (_first_root(first, second), _first_root(-first, -3 * second))
        return min(roots) * (1 - 1e-9)

    @property
    def _pair(self) -> tuple[float, float]:
        first, second = (*map(float, self.coefficients), 0.0, 0.0)[:2]
        return first, second

    def _square(self, arms: Points) -> Values:
        """Squared radii, none so large that its powers overflow."""
        return np.asarray(np.minimum((arms**2).sum(axis=1) / self.radius**2, 1e24))

    def _division(self, square: Values) -> Values:
        first, second = self._pair
        return np.asarray(1.0 + square * (first + square * second))

    def _rise(self, square: Values) -> Values:
        """Derivative of the division by the squared radius."""
        first, second = self._pair
        return np.asarray(first + 2 * second * square)

    def _powers(self, square: Values) -> Points:
        """Derivative of the division by each coefficient, (k, n)."""
        return np.stack([square, square**2])[: len(self.coefficients)]

    def _seen(self, ideal: Values) -> tuple[Values, Mask]:
        """Seen radius of each ideal one, 0 where there is none, and where there is one."""
        first, second = self._pair
        if second == 0.0:
            bend = 1.0 - 4.0 * first * ideal**2
            inside = (bend > 1e-9) & (ideal < 1e9)
            return np.where(inside, 2 * ideal / (1 + np.sqrt(np.where(inside, bend, 1.0))), 0.0), inside
        edge = float(np.sqrt(self.limit))
        division = float(self._division(np.array(self.limit)))
        inside = ideal * division < edge
        return np.where(inside, self._solved(np.where(inside, ideal, 0.0), edge), 0.0), inside

    def _solved(self, ideal: Values, edge: float) -> Values:
        """The radius below `edge` where ``r - ideal division(r^2)`` is 0: Newton's, in a bracket."""
        low, high = np.zeros_like(ideal), np.full_like(ideal, edge)
        at = np.minimum(ideal, edge)
        for _ in range(ROUNDS):
            square = at**2
            miss = at - ideal * self._division(square)
            high, low = np.where(miss > 0, at, high), np.where(miss > 0, low, at)
            slope = 1.0 - 2 * ideal * at * self._rise(square)
            step = np.divide(miss, slope, out=np.full_like(miss, np.inf), where=slope > 0)
            aimed = at - step
            new = np.where((aimed >= low) & (aimed <= high), aimed, (low + high) / 2)
            done = bool(np.all(np.abs(new - at) <= 1e-15 * (1 + at)))
            at = new
            if done:
                break
        return at


def _first_root(first: float, second: float) -> float:
    """Smallest z > 0 with 1 + first z + second z^2 = 0, or infinity."""
    inner = first * first - 4 * second
    if inner < 0:
        return np.inf
    # The stable form of 2 / (-first +- sqrt): no difference of near numbers for small `second`.
    roots = [2.0 / low for low in (-first + np.sqrt(inner), -first - np.sqrt(inner)) if low > 0]
    return min(roots, default=np.inf)
