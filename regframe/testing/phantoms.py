"""Images with a known answer: a visual-thermal street, and smooth blobs for quick checks."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.random import Generator
from scipy import ndimage

from regframe.errors import GeometryError
from regframe.geometry import AffineMap, Frame, Grid
from regframe.image import Image
from regframe.testing.painting import Canvas
from regframe.testing.street import paint_street
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Chain, Warp
from regframe.types import Points, Volume

Modality = Literal["mono", "inverted", "multimodal"]

# The canvas has more pixels than the visual frame by this factor, and reaches past it by this share of
# its height on every side.
FINER = 1.5
MARGIN = 0.35
LIGHT_BLUR_PX = 0.55
HEAT_BLUR_PX = 0.75
COUNTS_AT_FREEZING = 7900.0
COUNTS_PER_DEGREE = 35.0


@dataclass(frozen=True, eq=False)
class Phantom:
    """Two images and the warp that relates them.

    Parameters
    ----------
    fixed, moving : Image
    truth : Warp
        Takes fixed points to moving points.
    """

    fixed: Image
    moving: Image
    truth: Warp


def corner_error(warp: Warp | Chain, truth: Warp | Chain, grid: Grid) -> float:
    """Mean distance between where two warps put a grid's corners, in the moving image's unit.

    Examples
    --------
    >>> grid = Grid.of_shape((11, 11))
    >>> frame = Frame.about_centre(grid)
    >>> shifted = Warp(Translation(), np.array([3.0, 4.0]), frame)
    >>> corner_error(shifted, Warp(Translation(), np.zeros(2), frame), grid)
    5.0
    """
    corners = grid.corners()
    return float(np.linalg.norm(warp(corners) - truth(corners), axis=1).mean())


def misalignment(
    fixed: Grid,
    moving: Grid,
    *,
    angle_deg: float = 0.0,
    scale: float = 1.0,
    shift_px: Sequence[float] = (0.0, 0.0),
) -> Warp:
    """The similarity that departs from equal, centred fields of view by so much.

    Parameters
    ----------
    fixed, moving : Grid
        Two camera grids; equal fields of view means that both frames show the same width of the scene.
    angle_deg : float
        Rotation from x towards y.
    scale : float
        Above 1 the moving camera sees less of the scene.
    shift_px : (2,) floats
        Of the centre, in moving pixels.

    Examples
    --------
    >>> visual, thermal = Grid.of_shape((480, 640)), Grid.of_shape((384, 512))
    >>> misalignment(visual, thermal, scale=1.05, shift_px=(10, 0)).params
    array([  0.84,   0.  , -54.  , -48.  ])
    """
    equal = moving.shape[1] / fixed.shape[1]
    translation = moving.centre - fixed.centre + np.asarray(shift_px, dtype=np.float64)
    params = np.array([scale * equal, np.deg2rad(angle_deg), *translation])
    return Warp(Similarity(), params, Frame.about_centre(fixed))


def draw_misalignment(seed: int, fixed: Grid, moving: Grid) -> Warp:
    """A hand-mounted pair of cameras: 3-4 degrees, 4-6 percent, 15-20 px at 640 pixels of width."""
    rng = np.random.default_rng((seed, 1))
    towards = rng.uniform(0.0, 2.0 * np.pi)
    length = rng.uniform(15.0, 20.0) * moving.shape[1] / 640.0
    return misalignment(
        fixed,
        moving,
        angle_deg=rng.uniform(3.0, 4.0) * rng.choice([-1.0, 1.0]),
        scale=rng.uniform(1.04, 1.06) ** rng.choice([-1.0, 1.0]),
        shift_px=(length * np.cos(towards), length * np.sin(towards)),
    )


def visual_thermal(
    seed: int = 1,
    shape: tuple[int, int] = (480, 640),
    *,
    thermal_shape: tuple[int, int] | None = None,
    truth: Warp | None = None,
    noise: float = 1.0,
    hot_pixels: int = 0,
) -> Phantom:
    """A street seen by a visual and a thermal camera whose relation is known.

    Both frames are exposed from one painted scene with two independent layers, light and heat, the
    thermal one through the true warp, so the truth holds far below a hundredth of a pixel. The same seed
    gives the same scene whatever the truth, the noise and the thermal frame are.

    Parameters
    ----------
    seed : int
        Of the scene, of the truth unless given, and of the noise.
    shape : tuple of int
        Visual pixels, (ny, nx).
    thermal_shape : tuple of int, optional
        Thermal pixels, (ny, nx); by default four fifths of the visual frame.
    truth : Warp, optional
        From visual to thermal pixels, of a family that holds inverses, such as `projective-radial`; by
        default `draw_misalignment`.
    noise : float
        Strength of the noise of both sensors; 1 is typical, 0 is none.
    hot_pixels : int
        Number of stuck thermal pixels, half of them at either end of the scale.

    Returns
    -------
    Phantom
        Fixed: 8-bit visual frame. Moving: thermal counts in 16 bits, about 7000 to 9500.

    Raises
    ------
    GeometryError
        The true warp has no inverse, or shows parts that were not painted.

    Examples
    --------
    >>> phantom = visual_thermal(3, (96, 128))
    >>> phantom.fixed.raw.dtype, phantom.moving.raw.dtype, phantom.moving.grid.shape
    (dtype('uint8'), dtype('uint16'), (77, 102))
    """
    fixed = Grid.of_shape(shape)
    moving = Grid.of_shape(thermal_shape or (round(shape[0] * 0.8), round(shape[1] * 0.8)))
    truth = draw_misalignment(seed, fixed, moving) if truth is None else truth
    affine = truth.as_affine()
    back = truth.inverse() if affine is None else affine.inverse()
    canvas = _scene(seed, shape)
    light = _expose(canvas, canvas.light, fixed.points(fixed.all_indices()), LIGHT_BLUR_PX)
    blur = HEAT_BLUR_PX * _enlargement(back, moving)
    heat = _expose(canvas, canvas.heat, back(moving.points(moving.all_indices())), blur)
    rng = np.random.default_rng((seed, 2))
    visual = _visual_camera(light.reshape(fixed.shape), noise, rng)
    thermal = _thermal_camera(heat.reshape(moving.shape), noise, rng)
    stuck = rng.choice(thermal.size, hot_pixels, replace=False)
    thermal.flat[stuck[::2]], thermal.flat[stuck[1::2]] = 16383, 0
    return Phantom(
        Image.of_array(visual, name="visual phantom"), Image.of_array(thermal, name="thermal phantom"), truth
    )


def smooth_pair(kind: Modality = "mono", shape: tuple[int, ...] = (48, 56), *, seed: int = 1) -> Phantom:
    """Two smooth aligned images in 2-D or 3-D, for checks that must be quick.

    Parameters
    ----------
    kind : str
        How the moving intensity follows the fixed one: "mono" equal, "inverted" reversed,
        "multimodal" neither rising nor falling, with dark and bright parts sharing a level.
    shape : tuple of int
        Of both images, (ny, nx) or (nz, ny, nx).
    seed : int

    Examples
    --------
    >>> pair = smooth_pair("inverted", (20, 24))
    >>> float(np.corrcoef(pair.fixed.values.ravel(), pair.moving.values.ravel())[0, 1].round(1))
    -1.0
    """
    rng = np.random.default_rng((seed, 3))
    width = max(min(shape) / 12.0, 1.2)
    fixed = _blobs(rng, shape, width)
    own = 0.02 * _blobs(rng, shape, width)
    changed = {
        "mono": fixed,
        "inverted": 1.0 - fixed,
        "multimodal": 0.5 - 0.5 * np.cos(2.0 * np.pi * (fixed - np.median(fixed) + 0.02)),
    }
    grid = Grid.of_shape(shape)
    truth = Warp(Translation(), np.zeros(grid.dim), Frame.about_centre(grid))
    images = [Image(100.0 * values, grid, name=kind) for values in (fixed, changed[kind] + own)]
    return Phantom(images[0], images[1], truth)


def _enlargement(back: Warp | AffineMap, moving: Grid) -> float:
    """Visual lengths over thermal ones in the middle of the thermal frame."""
    if isinstance(back, AffineMap):
        return float(np.sqrt(abs(np.linalg.det(back.matrix))))
    steps = 0.5 * np.eye(2)
    slopes = back(moving.centre + steps) - back(moving.centre - steps)
    return float(np.sqrt(abs(np.linalg.det(slopes))))


def _scene(seed: int, shape: tuple[int, int]) -> Canvas:
    height, width = shape
    extent = [int(np.ceil((n + 2 * MARGIN * height) * FINER)) for n in (height, width)]
    canvas = Canvas(
        (extent[0], extent[1]), FINER * height, (-MARGIN, -MARGIN), np.random.default_rng((seed, 0)), height
    )
    paint_street(canvas)
    return canvas


def _expose(canvas: Canvas, layer: Volume, points: Points, blur_px: float) -> Volume:
    # One band-limited layer, read at exact places by a cubic spline: the truth has no rounding to pixels.
    blurred = ndimage.gaussian_filter(layer, blur_px * FINER, truncate=3.5)
    places = canvas.places(points)
    if not np.all((places >= 0.0) & (places <= np.array(canvas.shape) - 1.0)):
        message = (
            f"the thermal frame looks past the painted scene, which ends {MARGIN:.0%} of the visual height "
            "outside the visual frame. Choose a truth with a smaller scale change, rotation or shift."
        )
        raise GeometryError(message)
    return np.asarray(ndimage.map_coordinates(blurred, places.T, order=3, mode="mirror"))


def _radius(shape: tuple[int, ...]) -> Volume:
    down, across = (np.linspace(-1.0, 1.0, n) for n in shape)
    return np.asarray((down[:, None] ** 2 + across**2) / 2.0)


def _visual_camera(
    light: Volume, noise: float, rng: Generator
) -> "np.ndarray[tuple[int, ...], np.dtype[np.uint8]]":
    seen = np.clip(light, 0.0, 1.1) * (1.0 - 0.28 * _radius(light.shape))
    level = 255.0 * np.clip(seen, 0.0, 1.0) ** 0.85
    level += noise * (0.8 + 0.10 * np.sqrt(level)) * rng.standard_normal(level.shape)
    return np.clip(np.rint(level), 0, 255).astype(np.uint8)


def _thermal_camera(
    heat: Volume, noise: float, rng: Generator
) -> "np.ndarray[tuple[int, ...], np.dtype[np.uint16]]":
    # A warm lens rim, each column's own offset and the sensor's noise, as uncooled cameras have them.
    seen = heat + 1.6 * _radius(heat.shape)
    seen = seen + noise * (0.10 * rng.standard_normal(heat.shape[1]) + 0.12 * rng.standard_normal(heat.shape))
    counts = COUNTS_AT_FREEZING + COUNTS_PER_DEGREE * seen
    return np.clip(np.rint(counts), 0, 16383).astype(np.uint16)


def _blobs(rng: Generator, shape: tuple[int, ...], width: float) -> Volume:
    coarse = ndimage.gaussian_filter(rng.standard_normal(shape), 2.0 * width)
    fine = ndimage.gaussian_filter(rng.standard_normal(shape), width)
    field = coarse / coarse.std() + 0.6 * fine / fine.std()
    return np.asarray((field - field.min()) / (field.max() - field.min()))
