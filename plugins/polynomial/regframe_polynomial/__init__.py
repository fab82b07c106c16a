"""A polynomial warp, in the plane and in space."""

from collections.abc import Iterator
from itertools import combinations_with_replacement
from typing import ClassVar, final

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray
from pydantic import Field

from regframe import AffineMap, Frame, Transform

Floats = NDArray[np.float64]
BLOCK = 2**16  # points at a time: for all of a volume the products would fill the memory


@final
class Polynomial(Transform):
    """Displacement by a polynomial of the position: few parameters for lenses and smooth bends.

    R. Woods, S. Grafton, J. Watson, N. Sicotte and J. Mazziotta, "Automated image registration: II.
    Intersubject validation of linear and nonlinear models", J. Computer Assisted Tomography 22(1), 1998,
    whose powers are here Legendre polynomials of the position from -1 to 1 along each axis of the fixed
    image. They span the same warps; as they hardly overlap, a descent needs fewer steps. Each is 1 at the
    corners and nowhere more, so a parameter is a motion in pixels (or mm), whatever its power. Parameters:
    the motion along x by each product of total degree up to `degree`, then along y (, z). An affine start
    is taken over exactly.
    """

    closed: ClassVar[bool] = False

    degree: int = Field(
        3, ge=2, le=8, description="Highest total power: 2 bends and tapers, 3 has lens distortion."
    )

    def identity(self, frame: Frame) -> Floats:
        """No displacement."""
        return np.zeros(frame.dim * len(self._powers(frame.dim)))

    def names(self, frame: Frame) -> tuple[str, ...]:
        """The direction of motion, and the power along each axis: x[xxy] is P2(x) P1(y) along x."""
        axes = "xyz"[: frame.dim]
        products = ["".join(axes[axis] for axis in power) or "1" for power in self._powers(frame.dim)]
        return tuple(f"{axis}[{product}]" for axis in axes for product in products)

    def map(self, params: Floats, points: Floats, frame: Frame) -> Floats:
        """Moving points of (n, dim) fixed points, physical, x first."""
        table, moved = params.reshape(frame.dim, -1), points.copy()
        for part, products in self._products(points, frame):
            moved[part] += np.einsum("nm,am->na", products, table)
        return moved

    def parameter_gradient(self, params: Floats, points: Floats, forces: Floats, frame: Frame) -> Floats:
        """Sum over points of ``forces . d map / d params``, (p,)."""
        total = np.zeros((frame.dim, len(self._powers(frame.dim))))
        for part, products in self._products(points, frame):
            total += np.einsum("na,nm->am", forces[part], products)
        return total.ravel()

    def shift(self, params: Floats, frame: Frame) -> Floats:
        """One: every product is 1 at a corner, and nowhere on the grid more."""
        return np.ones_like(params)

    def from_affine(self, affine: AffineMap, frame: Frame) -> Floats:
        """The affine map itself: its displacement is linear in the positions."""
        middle, half = _extent(frame)
        ends = np.vstack([np.zeros(frame.dim), np.diag(half)[::-1]]) + middle
        points = frame.grid.points(ends)
        displacement = affine(points) - points
        table = np.zeros((frame.dim, len(self._powers(frame.dim))))
        table[:, 0] = displacement[0]
        table[:, 1 : frame.dim + 1] = (displacement[1:] - displacement[0]).T
        return table.ravel()

    def _powers(self, dim: int) -> list[tuple[int, ...]]:
        """The axes that each product holds: (), (x,), (y,), (x, x), (x, y), (y, y) ..."""
        return [
            axes
            for degree in range(self.degree + 1)
            for axes in combinations_with_replacement(range(dim), degree)
        ]

    def _products(self, points: Floats, frame: Frame) -> Iterator[tuple[slice, Floats]]:
        """Some of the points at a time, and the products there, (n, m)."""
        middle, half = _extent(frame)
        counts = np.array(
            [[power.count(axis) for axis in range(frame.dim)] for power in self._powers(frame.dim)]
        )
        for first in range(0, len(points), BLOCK):
            part = slice(first, first + BLOCK)
            place = (frame.grid.indices(points[part]) - middle) / half
            products = np.ones((len(place), len(counts)))
            for axis, along in enumerate(place.T[::-1]):
                products *= legvander(along, self.degree)[:, counts[:, axis]]
            yield part, products


def _extent(frame: Frame) -> tuple[Floats, Floats]:
    """Middle and half length of each axis in pixels, array order; an axis of one pixel counts as one long."""
    last = np.array(frame.grid.shape, np.float64) - 1
    return last / 2, np.maximum(last, 1) / 2
