"""Agreement of the directions of gradients."""

from typing import ClassVar, Literal, NamedTuple, final

import numpy as np
from pydantic import Field

from regframe.kernels import edges
from regframe.kernels.sharing import share
from regframe.metrics.base import Metric, Pairs
from regframe.types import Values, Volume

ROUNDING = 1e-9
"""Of the largest intensity: smaller slopes are what interpolation leaves of a constant image."""


@final
class NormalisedGradientFields(Metric):
    """Mean squared sine of the angle between both images' gradients, in [0, 1]; short gradients count as 1.

    Haber and Modersitzki, "Intensity gradient based registration and fusion of multi-modal images", MICCAI
    2006: images match where their edges run alike, whichever side is brighter. A gradient g is divided by
    sqrt(|g|^2 + e^2); the edge parameter e is the paper's automatic choice, `noise` times the mean length of
    the image's gradients. They are central differences by grid points, so a grid should be about as fine
    along each axis, and only points count whose neighbours all have weight. Without any such point the value
    is infinite.
    """

    noise: float = Field(
        1.0,
        gt=0,
        le=100,
        description="Gradients shorter than this share of the mean one are taken for noise.",
    )

    layout: ClassVar[Literal["points", "grid"]] = "grid"
    suits: ClassVar[tuple[str, ...]] = ("mono", "inverted", "multimodal")
    invariant_to: ClassVar[tuple[str, ...]] = ("shift", "scale", "inversion")

    def prepare(self, pairs: Pairs) -> Volume:
        """Normalised gradients of the fixed image, (3, nz, ny, nx)."""
        field = self._field(pairs.fixed, pairs, pairs.fixed_range)
        lengths = np.sqrt(np.sum(field.gradient * field.gradient, axis=0) + field.squared_edge)
        return np.asarray(field.gradient / lengths)

    def value(self, pairs: Pairs) -> float:
        """1 - sum w <nf, nm>^2 / sum w, with n = g / sqrt(|g|^2 + e^2) of either image."""
        return self._met(pairs).value

    def derivative(self, pairs: Pairs) -> Values:
        """Slope of the value by each moving intensity."""
        return self.value_and_derivative(pairs)[1]

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Values]:
        """The value, and its slope by each moving intensity.

        With c = <nf, g> / q and q^2 = |g|^2 + e^2: d c / d g = nf / q - c g / q^2, and
        d c / d e = - c e / q^2 where e itself follows the lengths of all gradients. Central differences are
        walked back to the two neighbours they came from.
        """
        at = self._met(pairs)
        field, slopes = at.field, np.zeros_like(at.cosine)
        if field.mass:
            felt, steep = (
                np.empty_like(field.gradient),
                2.0 * self.noise * field.edge * at.bent / field.mass**2,
            )
            rows = slopes.size // slopes.shape[-1]
            found = (field.gradient, at.fixed, field.weight, field.squared_edge, at.cosine)
            share(edges.forces, rows, *found, -2.0 / field.mass, steep, felt)
            share(edges.back, rows, felt, slopes)
        return at.value, slopes.ravel()

    def _met(self, pairs: Pairs) -> "Met":
        fixed = pairs.prepared if isinstance(pairs.prepared, np.ndarray) else self.prepare(pairs)
        field = self._field(pairs.moving, pairs, pairs.moving_range)
        shape = field.weight.shape
        cosine, sums = np.empty(shape), np.empty((shape[0] * shape[1], 2))
        share(
            edges.agreement, len(sums), field.gradient, fixed, field.weight, field.squared_edge, cosine, sums
        )
        agreed, bent = map(float, sums.sum(axis=0))
        value = 1.0 - agreed / field.mass if field.mass else float("inf")
        return Met(value, fixed, field, cosine, bent)

    def _field(self, values: Values, pairs: Pairs, span: tuple[float, float]) -> "Gradients":
        shape = pairs.shape or pairs.weight.shape  # layout "grid" always has a shape
        shape = (1,) * (3 - len(shape)) + tuple(shape)
        volume, given = (np.ascontiguousarray(part.reshape(shape)) for part in (values, pairs.weight))
        gradient, weight = np.empty((3, *shape)), np.empty(shape)
        sums = np.empty((shape[0] * shape[1], 2))
        share(edges.differences, len(sums), volume, given, gradient, weight, sums)
        steepness, mass = map(float, sums.sum(axis=0))
        edge = self.noise * steepness / (mass or 1.0)
        least = ROUNDING * max(*map(abs, span)) or 1.0
        return Gradients(gradient, weight, mass, edge, edge * edge + least * least)


class Gradients(NamedTuple):
    """Of one image."""

    gradient: Volume  # (3, nz, ny, nx), 0 where the weight is
    weight: Volume  # where all neighbours have some
    mass: float
    edge: float
    squared_edge: float  # with what rounding leaves of a constant image


class Met(NamedTuple):
    """What both images have in common."""

    value: float
    fixed: Volume  # normalised gradients
    field: Gradients  # of the moving image
    cosine: Volume
    bent: float  # sum of w c^2 / q^2
