"""One grey value of a colour picture."""

from typing import Any, Literal, final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from regframe.errors import ImageError
from regframe.filters.base import Filter
from regframe.image import Image, grey
from regframe.types import Points, Values

CHANNELS = {"red": 0, "green": 1, "blue": 2}
CELLS = 32
"""Cells along each axis of the colour space: fine enough for a palette of 256 colours, coarse enough to meet
colours that noise and interpolation put beside it."""
MOST = 3000
"""Cells that a palette may fill. A rainbow runs through some 400, and JPEG scatters it over 2200.
The work grows with the square."""


@final
class Grey(Filter):
    """Takes one grey value of a colour picture: its luma, a channel, or the place along its palette.

    Luma rises and falls along a rainbow, so unlike values look alike. `palette` undoes a false-colour
    palette without knowing it: where values change smoothly, the colours of a picture lie on a curve, and a
    grey value is the length of the way along it from the darkest colour, in the unit of the channels. The
    way is the one of least squared steps, which goes from neighbour to neighbour and cuts across only
    where colours between are missing. Of a photograph it makes nonsense. Grey stored as colour stays grey
    but for a factor, and grey images pass unchanged. The pixels are taken as they were stored, so this
    filter comes first.
    """

    channel: Literal["luma", "red", "green", "blue", "palette"] = Field(
        "luma",
        description=(
            "Which: 0.299 R + 0.587 G + 0.114 B (ITU-R BT.601), one channel, or the place along the palette."
        ),
    )

    def __call__(self, image: Image) -> Image:
        """The image with the chosen grey.

        Raises
        ------
        ImageError
            A palette is asked for, and the picture has too many colours for one.
        """
        raw = image.raw
        if raw is None or raw.ndim == image.dim:
            return image
        if self.channel == "luma":
            return image.with_rounded(grey(raw))
        if self.channel == "palette":
            colours = raw[..., :3].reshape(-1, 3).astype(np.float64)
            return image.with_rounded(along_palette(colours, image.name).reshape(image.grid.shape))
        return image.with_rounded(raw[..., CHANNELS[self.channel]])


def along_palette(colours: Points, name: str = "image") -> Values:
    """Length of the way along the curve that colours lie on, from the darkest one.

    Parameters
    ----------
    colours : (n, 3) float64
    name : str
        What an error calls the image.

    Returns
    -------
    (n,) float64, in the unit of the channels; 0 for the darkest

    Raises
    ------
    ImageError
        More colours than lie on a curve.

    Examples
    --------
    >>> import numpy as np
    >>> ramp = np.linspace(0.0, 255.0, 256)[:, None]
    >>> black_to_blue_to_violet = np.vstack([ramp * [0, 0, 1], [0, 0, 255] + ramp * [1, 0, 0]])
    >>> along_palette(black_to_blue_to_violet)[[0, 200, 511]].round(-1)
    array([  0., 200., 510.])
    """
    nodes, members = _cells(colours, name)
    before = _predecessors(nodes)
    steps = nodes - nodes[before]
    lengths = np.linalg.norm(steps, axis=1)
    # The first node has none before it; its colours are laid along the way to the nearest of the others.
    first = int(np.argmin(lengths))
    after = np.flatnonzero(before == first)
    after = after[after != first]
    if not len(after):
        return np.zeros(len(colours))
    nearest = after[np.argmin(lengths[after])]
    steps[first], reach = steps[nearest], lengths[nearest]
    direction = steps / np.where(lengths > 0.0, lengths, reach)[:, None]
    ways = _ways(before, lengths, first)
    ways = ways[members] + np.einsum("nc,nc->n", colours - nodes[members], direction[members])
    return np.asarray(ways - ways.min())


def _cells(colours: Points, name: str) -> tuple[Points, NDArray[np.int64]]:
    """Mean colour of each cell that holds one, and every colour's cell."""
    low, span = colours.min(), max(float(np.ptp(colours)), np.finfo(np.float64).tiny)
    cell = np.minimum((colours - low) / span * CELLS, CELLS - 1).astype(np.int64)
    _, members, counts = np.unique(
        cell @ np.array([CELLS**2, CELLS, 1]), return_inverse=True, return_counts=True
    )
    if len(counts) > MOST:
        message = (
            f"{name}: its colours fill {len(counts)} cells, too many for a palette (at most {MOST}). "
            'Is it a photograph? Write channel = "luma", or leave the filter out.'
        )
        raise ImageError(message)
    sums = [np.bincount(members, colours[:, channel]) for channel in range(3)]
    return np.column_stack(sums) / counts[:, None], members


def _predecessors(nodes: Points) -> NDArray[np.int64]:
    """The node before each on the way of least squared steps from the darkest, which precedes itself."""
    from scipy.sparse.csgraph import dijkstra
    from scipy.spatial.distance import cdist

    first = int(np.argmin(nodes.sum(axis=1)))
    _, before = dijkstra(cdist(nodes, nodes, "sqeuclidean"), indices=first, return_predecessors=True)
    before = np.asarray(before, np.int64)
    before[first] = first
    return before


def _ways(before: NDArray[Any], lengths: Values, first: int) -> Values:
    """Length of the way from the first node to each."""
    ways, at = lengths.copy(), before.copy()
    while (at != first).any():
        ways += np.where(at == first, 0.0, lengths[at])
        at = before[at]
    return ways
