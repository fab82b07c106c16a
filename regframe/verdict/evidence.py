"""What speaks for and against a found map, in numbers that mean the same for every pair of images."""

from dataclasses import asdict, dataclass
from math import inf

import numpy as np

from regframe.engine.overlap import overlap, spread
from regframe.geometry import Grid
from regframe.image import Image
from regframe.transforms.warp import Chain, Warp
from regframe.verdict import edges, matching

NEAR_PX = 5.0
"""Moving pixels: what a verdict calls near."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What was found when a map was looked at without the search's own metric.

    Parameters
    ----------
    round_trip_px : float, optional
        Mean distance, in moving pixels, between a moving point and where it comes to rest when it is taken
        back by a second search, from the moving image to the fixed one, and forth by the map. None where no
        second search was made, infinite where it found nothing.
    parts : int
        Parts of the image, 12 at most, that both images cover and that were fitted each by itself.
    parts_near : float
        Share of the parts, by how much edge they hold and how clearly it fits, whose best place is within
        5 moving pixels of where the map puts them.
    leftover_px : float
        Typical distance, in moving pixels, of a part's best place from where the map puts it; infinite
        without parts.
    edge_fit : float
        How well edges coincide: 1 all, 0 no more than by chance.
    rival : float
        The best fit of edges when the moving image is shifted elsewhere, as a share of `edge_fit`;
        above 1 the images fit better elsewhere.
    sharpness : float
        `edge_fit` above the mean fit of other shifts, in their standard deviations.
    overlap : float
        Share of the smaller field of view that both images show.
    """

    round_trip_px: float | None
    parts: int
    parts_near: float
    leftover_px: float
    edge_fit: float
    rival: float
    sharpness: float
    overlap: float

    def record(self) -> dict[str, float | int | None]:
        """The numbers by name."""
        return asdict(self)


def gather(fixed: Image, moving: Image, warp: Warp | Chain, *, round_trip_px: float | None) -> Evidence:
    """The evidence on a map between two images in 2-D.

    Parameters
    ----------
    fixed, moving : Image
        After their filters.
    warp : Warp or Chain
        From fixed to moving points.
    round_trip_px : float or None
        See `round_trip`; None where no second search was made.
    """
    grid, below, above = edges.pair(fixed, moving, warp)
    step = edges.stretch(warp, fixed.grid) * grid.spacing[0] / moving.grid.spacing[0]
    parts, peak = matching.tiles(below, above), matching.peak(below, above)
    return Evidence(
        round_trip_px=round_trip_px,
        parts=len(parts.weights),
        parts_near=parts.share_within(NEAR_PX / step),
        leftover_px=parts.typical() * step if len(parts.weights) else inf,
        edge_fit=peak.height,
        rival=peak.rival,
        sharpness=peak.sharpness,
        overlap=overlap(warp, fixed.grid, moving.grid),
    )


def round_trip(warp: Warp | Chain, back: Warp | Chain | None, fixed: Grid, moving: Grid) -> float:
    """Mean distance, in moving pixels, of moving points from where the way back and forth takes them.

    Parameters
    ----------
    warp : Warp or Chain
        From fixed to moving points.
    back : Warp or Chain or None
        From moving to fixed points; None, for a search that found nothing, is infinitely far.
    fixed, moving : Grid

    Returns
    -------
    float
        Infinite where no fixed point meets the moving image.
    """
    if back is None:
        return inf
    met = warp(spread(fixed))
    met = met[np.isfinite(met).all(axis=1)]
    met = met[moving.inside(moving.indices(met))]
    if not len(met):
        return inf
    again = warp(back(met))
    apart = np.linalg.norm(moving.indices(again) - moving.indices(met), axis=1)
    mean = float(apart.mean())
    return mean if np.isfinite(mean) else inf
