"""A canvas with two layers, light and heat, that anti-aliased shapes are painted on.

World units: one is the height of the visual frame, x to the right and y down, its upper left corner at
the origin. The canvas reaches past that frame on every side, so that a second camera can look askew.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from regframe.types import Indices, Points, Volume

TILE = 512
Spot = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Look:
    """How a material appears to either camera; None leaves what lies behind it.

    Parameters
    ----------
    light : float or None
        Reflectance, 0 to 1.
    heat : float or None
        Apparent temperature, degrees Celsius.
    light_grain, heat_grain : float
        Strength of the texture that only this camera sees, in the same units.
    """

    light: float | None = None
    heat: float | None = None
    light_grain: float = 0.02
    heat_grain: float = 0.3


@dataclass(frozen=True, eq=False, slots=True)
class Patch:
    """A part of the canvas and how much of each of its pixels a shape covers."""

    rows: slice
    columns: slice
    cover: Volume


def tile(rng: Generator, roughness: float) -> Volume:
    """Random texture of mean 0 and deviation 1 that repeats without a seam, (TILE, TILE).

    Parameters
    ----------
    roughness : float
        Exponent of the falling amplitude spectrum: 0.6 is gravel, 1.7 is clouds.
    """
    along = np.fft.rfftfreq(TILE)
    across = np.fft.fftfreq(TILE)[:, None]
    radius = np.hypot(along, across)
    radius[0, 0] = np.inf
    phase = np.exp(2j * np.pi * rng.random(radius.shape))
    texture = np.fft.irfft2(phase * radius**-roughness, s=(TILE, TILE))
    return np.asarray((texture - texture.mean()) / texture.std())


@dataclass(eq=False)
class Canvas:
    """Two layers over the same ground: light (0 to 1) and heat (degrees Celsius).

    Parameters
    ----------
    shape : tuple of int
        Pixels, (ny, nx).
    scale : float
        Canvas pixels per world unit.
    corner : tuple of float
        World position (x, y) of the centre of the first pixel.
    rng : Generator
        Draws textures and their places.
    unit_px : int
        Visual pixels per world unit.
    """

    shape: tuple[int, int]
    scale: float
    corner: Spot
    rng: Generator
    unit_px: int
    light: Volume = field(init=False)
    heat: Volume = field(init=False)
    gravel: Volume = field(init=False)
    clouds: Volume = field(init=False)

    def __post_init__(self) -> None:
        self.light = np.zeros(self.shape)
        self.heat = np.zeros(self.shape)
        self.gravel = tile(self.rng, 0.7)
        self.clouds = tile(self.rng, 2.0)

    @property
    def span(self) -> tuple[float, float]:
        """Leftmost and rightmost world x."""
        return self.corner[0], self.corner[0] + (self.shape[1] - 1) / self.scale

    def box(self, left: float, top: float, right: float, bottom: float) -> Patch:
        """An upright rectangle."""
        rows, columns, y, x = self._window((left, top), (right, bottom))
        across = _reach(x, left, right, self.scale)
        down = _reach(y, top, bottom, self.scale)
        return Patch(rows, columns, down[:, None] * across)

    def polygon(self, corners: Sequence[Spot]) -> Patch:
        """A simple polygon, either way round."""
        spots = np.asarray(corners, dtype=np.float64)
        rows, columns, y, x = self._window(spots.min(axis=0), spots.max(axis=0))
        closed = np.concatenate([spots, spots[:1]])
        distance = _distance(x, y, closed, 2.0 / self.scale)
        within = np.zeros(distance.shape, dtype=np.bool_)
        for (ax, ay), (bx, by) in pairwise(closed):
            first, last = np.searchsorted(y, [min(ay, by), max(ay, by)])
            if first < last:
                crossing = ax + (y[first:last] - ay) / (by - ay) * (bx - ax)
                within[first:last] ^= x < crossing[:, None]
        return Patch(rows, columns, _edge(np.where(within, distance, -distance) * self.scale))

    def disc(self, centre: Spot, across: float, down: float | None = None) -> Patch:
        """An upright ellipse of half axes `across` and `down`."""
        down = across if down is None else down
        rows, columns, y, x = self._window(
            (centre[0] - across, centre[1] - down), (centre[0] + across, centre[1] + down)
        )
        radius = np.hypot((x - centre[0]) / across, (y[:, None] - centre[1]) / down)
        return Patch(rows, columns, _edge((1.0 - radius) * min(across, down) * self.scale))

    def bush(self, centre: Spot, across: float, down: float) -> Patch:
        """An ellipse with a ragged rim."""
        patch = self.disc(centre, 1.3 * across, 1.3 * down)
        y = np.arange(patch.rows.start, patch.rows.stop) / self.scale + self.corner[1]
        x = np.arange(patch.columns.start, patch.columns.stop) / self.scale + self.corner[0]
        radius = np.hypot((x - centre[0]) / across, (y[:, None] - centre[1]) / down)
        inner = 1.0 - radius + 0.35 * self.texture(patch, self.gravel)
        return Patch(patch.rows, patch.columns, _edge(inner * min(across, down) * self.scale) * patch.cover)

    def glow(self, centre: Spot, across: float, down: float | None = None) -> Patch:
        """A Gaussian spot whose deviation is half of `across` and `down`."""
        down = across if down is None else down
        rows, columns, y, x = self._window(
            (centre[0] - 2 * across, centre[1] - 2 * down), (centre[0] + 2 * across, centre[1] + 2 * down)
        )
        along = np.exp(-2.0 * ((x - centre[0]) / across) ** 2)
        return Patch(rows, columns, np.exp(-2.0 * ((y[:, None] - centre[1]) / down) ** 2) * along)

    def stroke(self, path: Sequence[Spot], width: float) -> Patch:
        """A line of some width with round ends."""
        spots = np.asarray(path, dtype=np.float64)
        rows, columns, y, x = self._window(spots.min(axis=0) - width / 2, spots.max(axis=0) + width / 2)
        inner = (width / 2 - _distance(x, y, spots, width / 2 + 2.0 / self.scale)) * self.scale
        # A line thinner than a canvas pixel keeps its share of light rather than vanish.
        return Patch(rows, columns, _edge(inner) * min(1.0, width * self.scale))

    def paint(self, patch: Patch, look: Look) -> None:
        """Cover a patch with a material."""
        if look.light is not None:
            self._blend(self.light, patch, look.light + look.light_grain * self.texture(patch, self.gravel))
        if look.heat is not None:
            self._blend(self.heat, patch, look.heat + look.heat_grain * self.texture(patch, self.gravel))

    def shade(self, patch: Patch, factor: float) -> None:
        """Multiply the light of a patch: a shadow, or dirt; heat does not know."""
        part = self.light[patch.rows, patch.columns]
        part *= 1.0 + patch.cover * (factor - 1.0)

    def warm(self, patch: Patch, degrees: float) -> None:
        """Add heat to a patch; light does not know."""
        self.heat[patch.rows, patch.columns] += degrees * patch.cover

    def texture(self, patch: Patch, source: Volume) -> Volume:
        """A patch-sized piece of a tile, from a random place."""
        down, across = self.rng.integers(TILE, size=2)
        top, left = (patch.rows.start + down) % TILE, (patch.columns.start + across) % TILE
        height, width = patch.cover.shape
        if top + height <= TILE and left + width <= TILE:
            return source[top : top + height, left : left + width]
        rows, columns = np.arange(top, top + height), np.arange(left, left + width)
        wrapped: Volume = source[np.ix_(rows % TILE, columns % TILE)]
        return wrapped

    def places(self, points: Points) -> Indices:
        """Canvas indices, array order, of (n, 2) points in visual pixels."""
        world = (points + 0.5) / self.unit_px
        return np.asarray((world - np.array(self.corner))[:, ::-1] * self.scale)

    def everywhere(self) -> Patch:
        """The whole canvas."""
        return Patch(slice(0, self.shape[0]), slice(0, self.shape[1]), np.ones(self.shape))

    def heights(self) -> NDArray[np.float64]:
        """World y of each row, (ny, 1)."""
        return (np.arange(self.shape[0]) / self.scale + self.corner[1])[:, None]

    def _blend(self, layer: Volume, patch: Patch, colour: Volume) -> None:
        part = layer[patch.rows, patch.columns]
        part += patch.cover * (colour - part)

    def _window(
        self, low: Sequence[float] | Volume, high: Sequence[float] | Volume
    ) -> tuple[slice, slice, Volume, Volume]:
        parts = []
        for axis, length in ((1, self.shape[0]), (0, self.shape[1])):
            first = int(np.floor((low[axis] - self.corner[axis]) * self.scale)) - 1
            last = int(np.ceil((high[axis] - self.corner[axis]) * self.scale)) + 2
            first = min(max(first, 0), length)
            parts.append(slice(first, max(min(last, length), first)))
        rows, columns = parts
        y = np.arange(rows.start, rows.stop) / self.scale + self.corner[1]
        x = np.arange(columns.start, columns.stop) / self.scale + self.corner[0]
        return rows, columns, y, x


def _edge(inner: Volume) -> Volume:
    return np.clip(inner + 0.5, 0.0, 1.0)


def _reach(places: Volume, low: float, high: float, scale: float) -> Volume:
    first = np.maximum(places - 0.5 / scale, low)
    last = np.minimum(places + 0.5 / scale, high)
    return np.clip((last - first) * scale, 0.0, 1.0)


def _distance(x: Volume, y: Volume, path: Volume, reach: float) -> Volume:
    """Distance to a path, (ny, nx), right where it is at most `reach` and infinite further away."""
    squared = np.full((len(y), len(x)), np.inf)
    for (ax, ay), (bx, by) in pairwise(path):
        top, bottom = np.searchsorted(y, [min(ay, by) - reach, max(ay, by) + reach])
        left, right = np.searchsorted(x, [min(ax, bx) - reach, max(ax, bx) + reach])
        part = squared[top:bottom, left:right]
        away_x, away_y = x[left:right] - ax, y[top:bottom, None] - ay
        dx, dy = bx - ax, by - ay
        length = max(dx * dx + dy * dy, 1e-18)
        along = np.clip(away_x * (dx / length) + away_y * (dy / length), 0.0, 1.0)
        np.minimum(part, (away_x - along * dx) ** 2 + (away_y - along * dy) ** 2, out=part)
    distance: Volume = np.sqrt(squared)
    return distance
