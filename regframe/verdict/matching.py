"""How edges of two images fit under small shifts: over the whole image, and part by part."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from regframe.types import Points, Values
from regframe.verdict.edges import Edges

FAR = 0.25  # share of the width up to which other shifts are tried
BESIDE = 8.0  # pixels: a peak's own neighbourhood
HERE = 3.0  # pixels within which the map's own peak is looked for
LEAST_OVERLAP = 0.5  # of the overlap at the map, for another shift to count
TILES = (3, 4)
REACH = 12  # pixels that a tile is shifted by

Surface = NDArray[np.float32]
"""(ny, nx): how well edges fit at each shift, from -1 to 1, no shift in the middle."""


@dataclass(frozen=True)
class Peak:
    """How the fit at the map compares with the fits elsewhere.

    Parameters
    ----------
    height : float
        Share of edges that coincide within a few pixels of the map: 1 all, 0 as many as by chance.
    sharpness : float
        Height above the mean fit of other shifts, in their standard deviations.
    rival : float
        The best fit elsewhere, as a share of `height`.
    """

    height: float
    sharpness: float
    rival: float


@dataclass(frozen=True, eq=False)
class Tiles:
    """Where each part of the image fits best.

    Parameters
    ----------
    centres : (n, 2) float64
        Of the parts, pixels of the small grid, x first.
    shifts : (n, 2) float64
        What brings each part to its best fit, pixels of the small grid, x first.
    weights : (n,) float64
        How much edge there is in each part, and how clearly it fits.
    """

    centres: Points
    shifts: Points
    weights: Values

    def share_within(self, distance: float) -> float:
        """Share of parts, by weight, whose best fit is at most so many pixels from the map."""
        near = np.linalg.norm(self.shifts, axis=1) <= distance
        return float(self.weights[near].sum() / max(float(self.weights.sum()), 1e-12))

    def typical(self) -> float:
        """Weighted median length of the shifts, in pixels."""
        return weighted_median(np.linalg.norm(self.shifts, axis=1), self.weights)


def weighted_median(values: Values, weights: Values) -> float:
    """The value below which half of the weight lies.

    Examples
    --------
    >>> weighted_median(np.array([1.0, 2.0, 9.0]), np.array([1.0, 1.0, 0.1]))
    2.0
    """
    order = np.argsort(values, kind="stable")
    reached = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(reached, 0.5 * reached[-1])])


def peak(fixed: Edges, moving: Edges) -> Peak:
    """The fit at the map and elsewhere; nothing where too little of the images meets."""
    height, width = fixed.field.shape
    reach = max(round(FAR * max(height, width)), int(BESIDE) + 4)
    fit, overlap = surface(fixed, moving, reach)
    away = distances(fit.shape)
    if not overlap[away == 0.0].any():
        return Peak(0.0, 0.0, float("inf"))
    best = float(fit[away <= HERE].max())
    other = fit[(away > BESIDE) & (overlap >= LEAST_OVERLAP * overlap[away == 0.0])]
    if best <= 0.0 or not other.size:
        return Peak(max(best, 0.0), 0.0, float("inf"))
    spread = max(float(other.std()), 1e-6)
    return Peak(best, (best - float(other.mean())) / spread, float(other.max()) / best)


def tiles(fixed: Edges, moving: Edges) -> Tiles:
    """Each part of the fixed image fitted by itself, as far as the moving image reaches under it."""
    found = [one for box in _boxes(fixed.field.shape) if (one := _tile(fixed, moving, box)) is not None]
    if not found:
        return Tiles(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0))
    centres, shifts, weights = zip(*found, strict=True)
    return Tiles(np.array(centres), np.array(shifts), np.array(weights))


def surface(fixed: Edges, moving: Edges, reach: int) -> tuple[Surface, Surface]:
    """Correlation of fixed edges with moving ones shifted by up to `reach` pixels, and the overlap.

    Both fields lose their means and are weighted by where there is an image; the energies are those of
    the overlap at each shift (Padfield, "Masked object registration in the Fourier domain", IEEE TIP 2012,
    without the means of each overlap).

    Returns
    -------
    fit : (2 reach + 1, 2 reach + 1) float32
        At shift (y - reach, x - reach) of the moving edges; 0 where nothing meets.
    overlap : (2 reach + 1, 2 reach + 1) float32
        Pixels that meet.
    """
    from scipy import fft

    size = [fft.next_fast_len(n + reach, real=True) for n in fixed.field.shape]
    below, above = fixed.centred(), moving.centred()

    def sums(first: NDArray[np.float32], second: NDArray[np.float32]) -> Surface:
        product = np.conj(fft.rfft2(first, size)) * fft.rfft2(second, size)
        return _middle(fft.irfft2(product, size), reach)

    product = np.conj(fft.fft2(below, size)) * fft.fft2(above, size)
    met = _middle(fft.ifft2(product).real, reach)
    overlap = np.rint(sums(fixed.weight, moving.weight))
    energy = sums(_energy(below), moving.weight) * sums(fixed.weight, _energy(above))
    floor = 1e-4 * max(float(energy.max()), 1e-20)
    return np.where(overlap > 0, met / np.sqrt(np.maximum(energy, floor)), 0).astype(np.float32), overlap


def distances(shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Distance of each shift of a surface from no shift, in pixels."""
    down, across = (np.arange(n) - n // 2 for n in shape)
    return np.asarray(np.hypot(down[:, None], across), np.float64)


def _energy(field: NDArray[np.complex64]) -> NDArray[np.float32]:
    return (field.real**2 + field.imag**2).astype(np.float32)


def _middle(sums: NDArray[np.floating], reach: int) -> Surface:
    """The shifts from -reach to reach of a circular correlation, no shift in the middle."""
    rows, columns = (np.arange(-reach, reach + 1) % n for n in sums.shape)
    return np.asarray(sums[np.ix_(rows, columns)], np.float32)


def _boxes(shape: tuple[int, ...]) -> list[tuple[slice, slice]]:
    """The parts of an image, the longer axis cut more often."""
    counts = sorted(TILES, reverse=shape[0] > shape[1])
    cuts = [np.linspace(0, n, count + 1).round().astype(int) for n, count in zip(shape, counts, strict=True)]
    rows, columns = ([slice(*ends) for ends in pairwise(cut)] for cut in cuts)
    return [(row, column) for row in rows for column in columns]


def _tile(
    fixed: Edges, moving: Edges, box: tuple[slice, slice]
) -> tuple[tuple[float, float], tuple[float, float], float] | None:
    """Centre, best shift and weight of one part; None where the moving image covers too little of it."""
    here = fixed.part(box)
    if min(here.field.shape) < REACH or (moving.weight[box] * here.weight).mean() < LEAST_OVERLAP:
        return None
    around = tuple(slice(max(one.start - REACH, 0), one.stop + REACH) for one in box)
    # The part is set into a frame of zeros as large as what it may be shifted over.
    shape = moving.field[around].shape
    wide = Edges(np.zeros(shape, np.complex64), np.zeros(shape, np.float32))
    inner = tuple(
        slice(one.start - out.start, one.stop - out.start) for one, out in zip(box, around, strict=True)
    )
    wide.field[inner], wide.weight[inner] = here.field, here.weight
    fit, _ = surface(wide, moving.part(around), REACH)  # type: ignore[arg-type]
    row, column = divmod(int(fit.argmax()), fit.shape[1])
    shift = (column - REACH + _vertex(fit[row], column), row - REACH + _vertex(fit[:, column], row))
    centre = (0.5 * (box[1].start + box[1].stop - 1), 0.5 * (box[0].start + box[0].stop - 1))
    energy = float(np.sqrt(_energy(here.field).sum()))
    return centre, (float(shift[0]), float(shift[1])), energy * max(float(fit.max()), 0.0)


def _vertex(line: NDArray[np.float32], at: int) -> float:
    """Where the parabola through a maximum and its neighbours peaks, from the maximum."""
    if not 0 < at < len(line) - 1:
        return 0.0
    before, here, after = (float(line[at + step]) for step in (-1, 0, 1))
    bend = before - 2.0 * here + after
    return 0.0 if bend >= 0.0 else 0.5 * (before - after) / bend
