"""One level's images made ready: smoothed, sampled, prefiltered."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from regframe.engine.sampling import draw
from regframe.engine.setting import Setting
from regframe.errors import NoOverlapError
from regframe.geometry import AffineMap, Grid
from regframe.image import Image
from regframe.interpolators.base import Samples, mapped
from regframe.interpolators.nearest import Nearest
from regframe.kernels.gaussian import smooth
from regframe.kernels.rounding import round_single
from regframe.preset import Level, Stage
from regframe.transforms.warp import Chain, Warp
from regframe.types import Indices, Points, Values, Volume

RUN = 2**16  # points whose coordinates are held at once


@dataclass(frozen=True, eq=False)
class Scene:
    """What stays the same while a level's parameters change.

    Parameters
    ----------
    grid : Grid
        The level's shrunk fixed grid.
    samples : Samples
        Points of it that are compared.
    fixed, weight : (n,) float64
        Fixed intensities there, and 1 where they exist and count.
    still, moving : Image
        Fixed and moving image, smoothed.
    coefficients : volume
        The interpolator's, of the moving image.
    fixed_range, moving_range : tuple of float
    below : Warp or Chain, optional
        From samples to the fixed image, where they do not lie on its grid.
    """

    grid: Grid
    samples: Samples
    fixed: Values
    weight: Values
    still: Image
    moving: Image
    coefficients: Volume
    fixed_range: tuple[float, float]
    moving_range: tuple[float, float]
    below: Warp | Chain | None = None

    @cached_property
    def complete(self) -> bool:
        """Whether every sample counts in the fixed image."""
        return bool(self.weight.all())

    @cached_property
    def points(self) -> Points:
        """Physical points of the samples, (n, dim)."""
        return self.grid.points(self.samples.all_indices())

    @cached_property
    def moving_mask(self) -> Volume | None:
        """The moving mask as numbers, or None."""
        return None if self.moving.mask is None else self.moving.mask.astype(np.float64)


def smoothed(image: Image, sigma: float, unit: str = "physical") -> Image:
    """The image after a Gaussian of `sigma` mm (or pixels), or voxels; 0 leaves it as it is."""
    if sigma == 0.0:
        return image
    spacings = list(reversed(image.grid.spacing))
    # ITK makes millimetres of voxels and voxels of them again, which may change the last bit.
    lengths = [sigma * spacing if unit == "voxels" else sigma for spacing in spacings]
    per_axis = tuple(length / spacing for length, spacing in zip(lengths, spacings, strict=True))
    return image.with_values(smooth(image.values, per_axis))


def prepare(
    stage: Stage, level: Level, fixed: Image, moving: Image, seed: int, setting: Setting | None = None
) -> tuple[Scene, int]:
    """The level's scene, and the sampling seed of the next level."""
    setting = setting or Setting(fixed.grid)
    grid = setting.domain.coarsen(level.shrink)
    fixed, moving = (smoothed(image, level.smooth, stage.smooth_unit) for image in (fixed, moving))
    samples, seed = draw(level, grid, seed)
    interpolator = stage.interpolator
    index_map, at = _exact_places(grid, samples, fixed.grid, setting.below)
    values, weight = interpolator.resample(interpolator.prepare(_volume(fixed)), at, index_map)
    if fixed.rounds:
        round_single(values)
    counted = weight
    if fixed.mask is not None:
        marked = fixed.mask.astype(np.float64)
        weight = weight * Nearest().resample(marked, at, index_map)[0]
        if samples.indices is not None:
            counted = weight if setting.below is None else _drawn(grid, samples, fixed) * counted
            weight = weight * counted
    if not weight.any():
        message = (
            f"{fixed.name}: none of the {len(samples)} samples counts. "
            "Check the mask, or raise `fraction` in the preset."
        )
        raise NoOverlapError(message)
    return (
        Scene(
            grid,
            samples,
            values,
            weight,
            fixed,
            moving,
            interpolator.prepare(_volume(moving)),
            _fixed_range(stage, fixed, at, counted, whole=samples.indices is None),
            moving.range(),
            setting.below,
        ),
        seed,
    )


def _exact_places(
    grid: Grid, samples: Samples, fixed: Grid, below: Warp | Chain | None = None
) -> tuple[AffineMap | None, Samples]:
    """Where samples lie in the fixed image, to ITK's last bit.

    Integer grey levels on histogram edges need that bit, and only the long way through physical points
    has it. Where one affine map gives the same numbers, as on camera grids, it is the quick way to them.
    """

    def exact(indices: Indices) -> Indices:
        points = grid.points(indices)
        return fixed.indices(points if below is None else below(points))

    if grid is fixed and below is None and samples.indices is None:
        return None, samples
    if samples.indices is not None:
        return None, Samples(fixed.shape, exact(samples.indices))
    index_map = (fixed.point_to_index @ grid.index_to_point).reversed_axes()
    if below is None and all(
        np.array_equal(mapped(Samples(grid.shape, run), index_map), exact(run)) for run in _runs(grid)
    ):
        return index_map, samples
    places, first = np.empty((grid.size, grid.dim)), 0
    for run in _runs(grid):
        places[first : first + len(run)] = exact(run)
        first += len(run)
    return None, Samples(fixed.shape, places)


def _drawn(grid: Grid, samples: Samples, fixed: Image) -> Values:
    """1 where ITK keeps a drawn sample: it looks a mask up before it applies the map to the fixed image."""
    assert fixed.mask is not None
    places = fixed.grid.indices(grid.points(samples.all_indices()))
    return Nearest().resample(fixed.mask.astype(np.float64), Samples(fixed.grid.shape, places), None)[0]


def _runs(grid: Grid) -> Iterator[Indices]:
    """Index of every grid point, x fastest, `RUN` at a time: all of a head's take half a gigabyte."""
    for first in range(0, grid.size, RUN):
        run = np.arange(first, min(first + RUN, grid.size))
        yield np.stack(np.unravel_index(run, grid.shape), axis=1).astype(np.float64)


def _volume(image: Image) -> Volume:
    return np.ascontiguousarray(image.values, np.float64)


def _fixed_range(
    stage: Stage, fixed: Image, at: Samples, weight: Values, *, whole: bool
) -> tuple[float, float]:
    """Range under the mask, or over the pixels nearest to the samples where the metric asks for it."""
    if whole or stage.metric.range_of == "image":
        return fixed.range()
    near = np.floor(at.all_indices()[weight > 0] + 0.5).astype(np.int64)
    met = fixed.values[tuple(near.T)]
    return float(met.min()), float(met.max())
