"""How unlike two images are."""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal, Protocol, runtime_checkable

import numpy as np

from regframe.component import Component
from regframe.types import Matrix, Points, Scores, Values, Volume

Turned = Callable[[Matrix, tuple[int, int], float], tuple[Scores, Scores]]
"""As `Translations`, from a turned grid: its index map (2, 3) to the upright one, its shape, its angle."""


class Translations(Protocol):
    """A fixed image that is ready to meet others at every whole translation."""

    def __call__(self, moving: Volume, weight: Volume) -> tuple[Scores, Scores]:
        """From moving intensities and weights to the value and the shared weight."""


@runtime_checkable
class Turning(Translations, Protocol):
    """One that need not make anew what it compares for each rotation of a moving image."""

    def upright(self, moving: Volume, weight: Volume) -> Turned:
        """From moving intensities and weights on a grid in line with the fixed one."""


class Carried(Protocol):
    """A fixed image, and features of the moving one, made once, that maps between them carry along."""

    def value(self, index_map: Matrix) -> float:
        """The metric under a map from fixed to moving indices: (dim, dim + 1), z first, the offset last."""

    def value_and_slope(self, index_map: Matrix) -> tuple[float, Matrix]:
        """The metric, and its slope by the map, (dim, dim + 1), at fixed weights."""


@dataclass(frozen=True, slots=True)
class Pairs:
    """Intensities met at the same physical points.

    Parameters
    ----------
    fixed, moving : (n,) float64
        Intensities; where the weight is 0 they are finite but mean nothing.
    weight : (n,) float64, >= 0
        0 means 'not there': outside an image or a mask.
    fixed_range, moving_range : tuple of float
        Smallest and largest value of the level's images, under their masks; see `Metric.range_of`.
    shape : tuple of int or None
        The grid's shape, array order, when samples are a whole grid (`n` is its product).
    prepared : object
        What `Metric.prepare` returned for this level.
    single : bool
        Whether the intensities are those of float32 images, rounded as such.
    """

    fixed: Values
    moving: Values
    weight: Values
    fixed_range: tuple[float, float]
    moving_range: tuple[float, float]
    shape: tuple[int, ...] | None = None
    prepared: object = None
    single: bool = False

    def difference(self) -> Values:
        """``fixed - moving``, (n,); of float32 images in their precision, as ITK subtracts them."""
        difference = self.fixed - self.moving
        return difference.astype(np.float32).astype(np.float64) if self.single else difference


class Metric(Component):
    """How unlike two images are; lower is better.

    A metric is a function of paired intensities: it never sees an image, a transform, an interpolator,
    a mask, a level or a thread. One method is enough; the hooks add speed.

    `layout` "grid" asks for whole grids in place of loose samples. `range_of` "samples" asks for the fixed
    range over the pixels nearest to the samples where these are not a whole grid. `suits` lists the
    relations between the two images' intensities under which aligned images score best: "mono" (equal),
    "inverted", "multimodal" (any). `invariant_to` lists changes of the moving intensities that leave the
    value as it is: "shift", "scale", "inversion", "monotone" (any rising curve). The conformance suite holds
    a metric to what it lists. `unrelated` is the value of images that have nothing in common, where there is
    one: a search then trusts a value the less, the less the images overlap.
    """

    layout: ClassVar[Literal["points", "grid"]] = "points"
    range_of: ClassVar[Literal["image", "samples"]] = "image"
    suits: ClassVar[tuple[str, ...]] = ("mono",)
    invariant_to: ClassVar[tuple[str, ...]] = ()
    unrelated: ClassVar[float | None] = None

    @abstractmethod
    def value(self, pairs: Pairs) -> float:
        """One number, lower for better aligned images; infinite or NaN when nothing can be compared."""

    def derivative(self, pairs: Pairs) -> Values | None:
        """Hook: d value / d moving, (n,) float64, or None to let the engine difference `value`.

        The derivative is taken at fixed weights: a sample that leaves the image is a jump, not a slope.
        """
        return None

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Values | None]:
        """Hook: both at once, where they share work."""
        return self.value(pairs), self.derivative(pairs)

    def prepare(self, pairs: Pairs) -> object:
        """Hook: anything worth computing once a level; arrives in every later call as `pairs.prepared`.

        `pairs.moving` is not filled in yet; `pairs.fixed`, both ranges and the shape are.
        """
        return None

    def forces(self, pairs: Pairs, slopes: Points, spacing: tuple[float, ...]) -> Points | None:
        """Hook: what gradient optimizers follow in place of the slope of the value, as the demons do.

        Parameters
        ----------
        slopes : (n, dim) float64, per mm, x first
            Slope of the fixed image at the samples, as the stage's `gradient` says.
        spacing : tuple of float, mm, x first
            Of the fixed image.

        Returns
        -------
        (n, dim) float64, physical, x first, or None
            Uphill: a step against the force improves the match. 0 where the weight is 0.
        """
        return None

    def translations(self, pairs: Pairs, lattice: tuple[int, ...]) -> Translations | None:
        """Hook: how to score every whole translation at once, for `start = "search"`; None: one by one.

        The function returned takes the moving image's intensities and weights on a grid of the fixed
        grid's spacing. It gives two arrays of shape `lattice`: the metric, and the sum of the weights'
        products, at every translation t, where fixed grid point x meets moving grid point x + t; negative
        translations stand at the end. The metric may be an approximation in single precision: what is
        found is measured again by `value`. It is called from several threads. If it is `Turning`, each
        scale of the moving image is handed over once.

        Parameters
        ----------
        pairs : Pairs
            A whole fixed grid; `pairs.moving` is not filled in yet.
        lattice : tuple of int
            Large enough for both grids side by side as far as translations are of interest; its lengths are
            of those that `regframe.kernels.fourier.lattice` gives.
        """
        return None

    def carried(self, pairs: Pairs, moving: Volume, weight: Volume) -> Carried | None:
        """Hook: features that stay the same while a level's map changes a little; None: there are none.

        For levels with ``carried = true``: features of the moving image are made once, where the level
        begins, and resampled by the maps that are tried from there, in place of the intensities.

        Parameters
        ----------
        pairs : Pairs
            A whole fixed grid; `pairs.moving` is not filled in.
        moving, weight : 2-D float64
            Intensities on a grid of the same spacing and directions.
        """
        return None
