"""Numbers behind the plots: joint histograms and the course of a search."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from regframe.catalog import INTERPOLATORS
from regframe.engine.base import Progress, Result
from regframe.engine.resampling import resample
from regframe.geometry import Grid
from regframe.image import Image, Pixels
from regframe.transforms.warp import Chain, Warp

BINS = 256
JOINT_BINS = 96
MOST_SAMPLES = 1_000_000


def histogram(image: Image) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Counts and edges of an image's grey values under its mask, in 256 bins.

    Bins of integer images are whole grey levels wide, since other widths draw combs that are not there.

    Examples
    --------
    >>> counts, edges = histogram(Image.of_array(np.eye(3, dtype=np.uint8)))
    >>> len(counts), counts[:2].tolist(), edges[[0, -1]].tolist()
    (256, [6, 3], [-0.5, 255.5])
    """
    low, high = image.range()
    if _stored(image) == np.uint8:
        low, high = 0.0, 255.0
    edges = _edges(image, low, high, BINS)
    # Whole grey levels may need fewer bins; the rest stay empty at the upper end.
    edges = edges if len(edges) > BINS else edges[0] + (edges[1] - edges[0]) * np.arange(BINS + 1)
    return np.histogram(_counted(image), edges)[0], edges


@dataclass(frozen=True, eq=False)
class JointHistogram:
    """How often a fixed and a moving grey value meet.

    Parameters
    ----------
    counts : (fixed bins, moving bins) float64
    fixed_edges, moving_edges : (bins + 1,) float64
        The few values beyond are counted in the outer bins.
    """

    counts: NDArray[np.float64]
    fixed_edges: NDArray[np.float64]
    moving_edges: NDArray[np.float64]


def joint_histogram(result: Result, warp: Warp | Chain, *, bins: int = JOINT_BINS) -> JointHistogram:
    """Grey values that meet under a warp, inside both images and their masks."""
    fixed, moving = result.fixed, result.moving
    grid = fixed.grid
    coarse = max(1, round((grid.size / MOST_SAMPLES) ** (1 / grid.dim)))
    counted = np.ones(grid.shape, bool) if fixed.mask is None else fixed.mask
    below = fixed.values
    if coarse > 1:
        steps = (slice(None, None, coarse),) * grid.dim
        grid = _every(fixed, coarse)
        below, counted = below[steps], counted[steps]
    way = result.preset.stages[-1].interpolator
    above, inside = resample(moving.values, moving.grid, grid, warp, way)
    counted = counted & inside
    if moving.mask is not None:
        marked = moving.mask.astype(np.float64)
        counted &= resample(marked, moving.grid, grid, warp, INTERPOLATORS.build("nearest"))[0] > 0
    edges = [_edges(image, *_robust_range(image), bins) for image in (fixed, moving)]
    rows, columns = (_bins(values[counted], cut) for values, cut in zip((below, above), edges, strict=True))
    shape = (len(edges[0]) - 1, len(edges[1]) - 1)
    counts = np.bincount(rows * shape[1] + columns, minlength=shape[0] * shape[1])
    return JointHistogram(counts.reshape(shape).astype(np.float64), *edges)


def mutual_information(counts: NDArray[np.float64]) -> float:
    """Mutual information of a joint histogram, in bits; 0 where nothing meets.

    Examples
    --------
    >>> mutual_information(np.eye(4))
    2.0
    """
    share = counts / max(float(counts.sum()), 1.0)
    apart = share.sum(axis=1, keepdims=True) * share.sum(axis=0)
    met = share > 0
    return float((share[met] * np.log2(share[met] / apart[met])).sum())


@dataclass(frozen=True, eq=False)
class Course:
    """One level of a search, laid out along the metric evaluations of the whole run.

    Parameters
    ----------
    first, last : int
        Evaluations of the whole run before and after the level.
    steps : tuple of Progress
    """

    first: int
    last: int
    steps: tuple[Progress, ...]

    @property
    def evaluations(self) -> NDArray[np.int64]:
        """Evaluations of the whole run at each step."""
        return self.first + np.array([step.evaluations for step in self.steps], np.int64)


def courses(result: Result) -> list[Course]:
    """The levels of a run in order."""
    found, first = [], 0
    for level in result.levels:
        here = (level.stage, level.level)
        steps = tuple(step for step in result.trace if (step.stage, step.level) == here)
        last = first + max(level.evaluations, steps[-1].evaluations if steps else 0)
        found.append(Course(first, last, steps))
        first = last
    return found


def _every(image: Image, step: int) -> Grid:
    grid = image.grid
    shape = tuple(-(-n // step) for n in grid.shape)
    return Grid(shape, tuple(step * width for width in grid.spacing), grid.origin, grid.direction)


def _counted(image: Image) -> Pixels:
    return image.values if image.mask is None else image.values[image.mask]


def _stored(image: Image) -> "np.dtype[Any]":
    return image.values.dtype if image.raw is None else image.raw.dtype


def _edges(image: Image, low: float, high: float, bins: int) -> NDArray[np.float64]:
    """Edges of at most `bins` bins; those of integer images are whole grey levels wide."""
    if _stored(image).kind not in "ui":
        return np.linspace(low, high if high > low else low + 1, bins + 1)
    first, levels = int(np.floor(low)), int(np.ceil(high)) - int(np.floor(low)) + 1
    width = -(-levels // bins)
    return first - 0.5 + width * np.arange(-(-levels // width) + 1, dtype=np.float64)


def _robust_range(image: Image) -> tuple[float, float]:
    counted = _counted(image)
    drawn = counted.ravel()[:: max(1, counted.size // MOST_SAMPLES)]
    low, high = (float(edge) for edge in np.percentile(drawn, (0.5, 99.5)))
    return (low, high) if high > low else image.range()


def _bins(values: NDArray[np.floating], edges: NDArray[np.float64]) -> NDArray[np.int64]:
    width = edges[1] - edges[0]
    return np.asarray(np.clip((values - edges[0]) / width, 0, len(edges) - 2), np.int64)
