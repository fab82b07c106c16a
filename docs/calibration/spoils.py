"""Ways to make a pair of frames hard, or hopeless, to register."""

from collections.abc import Callable

import numpy as np

from regframe.geometry import AffineMap, Frame, Grid
from regframe.image import Image
from regframe.kernels.gaussian import smooth
from regframe.testing.phantoms import corner_error
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Chain, Warp

Error = Callable[[Warp | Chain], float]
"""How far a map is from the truth, in moving pixels."""
Spoilt = tuple[Image, Image, Error | None]


def error_of(truth: Warp | Chain, grid: Grid) -> Error:
    """Mean distance from the truth at a grid's corners."""
    return lambda warp: corner_error(warp, truth, grid)


def _noisy(fixed: Image, moving: Image, truth: Warp, rng: np.random.Generator) -> Spoilt:
    """Noise on the thermal frame, from as strong as its contrast to ten times that."""
    strength = float(moving.values.std()) * 10.0 ** rng.uniform(0.0, 1.0)
    noisy = moving.values + strength * rng.standard_normal(moving.grid.shape).astype(np.float32)
    return fixed, moving.with_rounded(noisy), error_of(truth, fixed.grid)


def _blank(fixed: Image, moving: Image, _: Warp, rng: np.random.Generator) -> Spoilt:
    """A thermal frame with its shutter closed: a warm rim and noise."""
    shape = moving.grid.shape
    down, across = (np.linspace(-1.0, 1.0, n) for n in shape)
    shading = 3.0 * (down[:, None] ** 2 + across**2) + rng.standard_normal(shape[1])
    blank = np.rint(8000.0 + shading + 2.0 * rng.standard_normal(shape))
    return fixed, moving.with_rounded(blank), None


def _dark(fixed: Image, moving: Image, _: Warp, rng: np.random.Generator) -> Spoilt:
    """A visual frame without light: noise of a few grey levels, some pixels hot."""
    dark = np.clip(np.rint(2.0 + 1.5 * rng.standard_normal(fixed.grid.shape)), 0, 255)
    dark[rng.random(dark.shape) < 1e-3] = 120.0
    return fixed.with_rounded(dark), moving, None


def _beyond(fixed: Image, moving: Image, truth: Warp, rng: np.random.Generator) -> Spoilt:
    """A camera that lies on its side, or hangs upside down: outside of the bounds of the search."""
    turns = int(rng.integers(1, 4))
    turned = np.ascontiguousarray(np.rot90(moving.values, turns))
    image = Image.of_array(turned, name=moving.name)
    there = _quarter(moving.grid, turns)
    return fixed, image, lambda warp: corner_error(warp, Chain((there, truth)), fixed.grid)


def _quarter(grid: Grid, turns: int) -> Warp:
    """From pixels of an array to those of the array turned as numpy.rot90 does."""
    matrix, offset = np.eye(2), np.zeros(2)
    wide = grid.shape[1]
    step, sizes = np.array([[0.0, 1.0], [-1.0, 0.0]]), list(grid.shape)
    for _ in range(turns):
        wide = sizes[1]
        matrix, offset = step @ matrix, step @ offset + np.array([0.0, wide - 1.0])
        sizes.reverse()
    return Warp.of_affine(AffineMap(matrix, offset), Frame.about_centre(grid))


def _repeated(fixed: Image, moving: Image, _: Warp, rng: np.random.Generator) -> Spoilt:
    """A wall of equal windows seen from two places: maps that differ by whole windows look the same."""
    shape, count = fixed.grid.shape, int(rng.integers(4, 7))
    period = [n // count for n in shape]
    top, left = (int(rng.integers(0, n - m)) for n, m in zip(shape, period, strict=True))
    walls = [
        np.tile(image.values[top : top + period[0], left : left + period[1]], (count + 4, count + 4))
        for image in (fixed, moving)
    ]
    # Up to one window and a bit along each axis, in whole pixels.
    down, across = (int(rng.integers(0, 2)) * m + int(rng.integers(0, m // 3)) for m in period)
    seen = walls[0][: shape[0], : shape[1]], walls[1][down : down + shape[0], across : across + shape[1]]
    truth = Warp(Translation(), np.array([-across, -down], float), Frame.about_centre(fixed.grid))
    return fixed.with_rounded(seen[0]), moving.with_rounded(seen[1]), error_of(truth, fixed.grid)


def _blurred(fixed: Image, moving: Image, truth: Warp, rng: np.random.Generator) -> Spoilt:
    """A thermal frame out of focus, by 1 to 4 pixels."""
    width = float(rng.uniform(1.0, 4.0))
    return fixed, moving.with_rounded(smooth(moving.values, (width, width))), error_of(truth, fixed.grid)


def _covered(fixed: Image, moving: Image, truth: Warp, rng: np.random.Generator) -> Spoilt:
    """A warm thing before the thermal camera: a rectangle over a tenth to six tenths of the frame."""
    share = float(rng.uniform(0.1, 0.6))
    values = moving.values.copy()
    height, width = (round(n * share**0.5) for n in values.shape)
    top, left = (int(rng.integers(0, n - m + 1)) for n, m in zip(values.shape, (height, width), strict=True))
    values[top : top + height, left : left + width] = values.max()
    return fixed, moving.with_rounded(values), error_of(truth, fixed.grid)


def _inverted(fixed: Image, moving: Image, truth: Warp, _: np.random.Generator) -> Spoilt:
    """Hot is black."""
    return fixed, moving.with_rounded(-moving.values), error_of(truth, fixed.grid)


SPOILS = {
    "noise": _noisy,
    "blank": _blank,
    "dark": _dark,
    "beyond": _beyond,
    "repeated": _repeated,
    "blurred": _blurred,
    "covered": _covered,
    "inverted": _inverted,
}
"""By name: takes the frames, the truth and a source of chance."""
