"""Agreement of the directions of gradients."""

from typing import ClassVar, Literal, NamedTuple, final

import numpy as np
from pydantic import Field

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
        """Normalised gradients of the fixed image, (dim, *shape)."""
        field = _field(pairs.fixed, _weights(pairs), pairs.fixed_range, self.noise)
        return np.asarray(field.gradient / field.length)

    def value(self, pairs: Pairs) -> float:
        """1 - sum w <nf, nm>^2 / sum w, with n = g / sqrt(|g|^2 + e^2) of either image."""
        return self._met(pairs).value

    def derivative(self, pairs: Pairs) -> Values:
        """Slope of the value by each moving intensity."""
        return self.value_and_derivative(pairs)[1]

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Values]:
        """The value, and its slope by each moving intensity.

        With s = <nf, g> / q and q = sqrt(|g|^2 + e^2): d s / d g = nf / q - s g / q^2, and
        d s / d e = - s e / q^2 where e itself follows the lengths of all gradients. Central differences are
        walked back to the two neighbours they came from.
        """
        at = self._met(pairs)
        if not at.mass:
            return at.value, np.zeros_like(pairs.moving)
        share = -2.0 * at.weight * at.cosine / at.mass
        field, cosine = at.field, at.cosine
        squared = field.length * field.length
        by_edge = -float(np.sum(share * cosine / squared)) * field.edge
        steepness = np.sqrt(np.sum(field.gradient**2, axis=0))
        along = by_edge * self.noise / at.mass * _divided(at.weight, steepness) - share * cosine / squared
        forces = share / field.length * at.fixed + along * field.gradient
        return at.value, _walked_back(forces).ravel()

    def _met(self, pairs: Pairs) -> "Met":
        fixed = pairs.prepared if isinstance(pairs.prepared, np.ndarray) else self.prepare(pairs)
        weight = _weights(pairs)
        field = _field(pairs.moving, weight, pairs.moving_range, self.noise)
        cosine = np.sum(fixed * field.gradient, axis=0) / field.length
        mass = float(weight.sum())
        value = 1.0 - float(np.sum(weight * cosine * cosine)) / mass if mass else float("inf")
        return Met(value, fixed, field, cosine, weight, mass)


class Gradients(NamedTuple):
    """Of one image."""

    gradient: Volume  # (dim, *shape), 0 where the weight is
    length: Volume  # sqrt(|g|^2 + e^2), never 0
    edge: float


class Met(NamedTuple):
    """What both images have in common."""

    value: float
    fixed: Volume  # normalised gradients
    field: Gradients  # of the moving image
    cosine: Volume
    weight: Volume
    mass: float


def _weights(pairs: Pairs) -> Volume:
    """Weights of the points whose neighbours along every axis have some too."""
    weight = pairs.weight.reshape(pairs.shape or pairs.weight.shape)  # layout "grid" always has a shape
    whole = np.zeros_like(weight)
    inner = (slice(1, -1),) * weight.ndim
    whole[inner] = weight[inner]
    for axis in range(weight.ndim):
        for side in (_ahead, _behind):
            whole[inner] *= side(weight, axis) > 0.0
    return whole


def _field(values: Values, weight: Volume, span: tuple[float, float], noise: float) -> Gradients:
    volume = values.reshape(weight.shape)
    gradient = np.zeros((weight.ndim, *weight.shape))
    inner = (slice(1, -1),) * weight.ndim
    for axis, along in enumerate(gradient):
        along[inner] = 0.5 * (_ahead(volume, axis) - _behind(volume, axis))
    gradient *= weight > 0.0
    squared = np.sum(gradient * gradient, axis=0)
    edge = noise * float(np.sum(weight * np.sqrt(squared))) / (float(weight.sum()) or 1.0)
    least = ROUNDING * max(*map(abs, span)) or 1.0
    return Gradients(gradient, np.sqrt(squared + (edge * edge + least * least)), edge)


def _walked_back(forces: Volume) -> Volume:
    """Slopes by intensity of a number with these slopes by central difference."""
    slopes = np.zeros(forces.shape[1:])
    inner = (slice(1, -1),) * slopes.ndim
    for axis, along in enumerate(forces):
        half = 0.5 * along[inner]
        _ahead(slopes, axis)[...] += half
        _behind(slopes, axis)[...] -= half
    return slopes


def _ahead(volume: Volume, axis: int) -> Volume:
    """The inner points' next neighbours along an axis; a view."""
    return volume[tuple(slice(2, None) if axis == other else slice(1, -1) for other in range(volume.ndim))]


def _behind(volume: Volume, axis: int) -> Volume:
    """The inner points' last neighbours along an axis; a view."""
    return volume[tuple(slice(None, -2) if axis == other else slice(1, -1) for other in range(volume.ndim))]


def _divided(values: Volume, by: Volume) -> Volume:
    """values / by, 0 where that is 0."""
    return np.divide(values, by, out=np.zeros_like(values), where=by > 0.0)
