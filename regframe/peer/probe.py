"""Single numbers asked of SimpleITK: a metric's value, its slope, smoothed and interpolated images."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from regframe.image import Image
from regframe.interpolators.base import Samples
from regframe.io.convert import array_to_sitk
from regframe.peer import convert, twins
from regframe.peer.faults import translated
from regframe.peer.method import Part, put, steady, told
from regframe.transforms.warp import Chain, Warp
from regframe.types import Params, Points, Values

if TYPE_CHECKING:
    import SimpleITK as sitk

    from regframe.peer.twins import Method

LARGEST = 1e300
"""ITK's value where nothing overlaps is the largest double; anything above this stands for it."""


def value_and_count(part: Part, fixed: Image, moving: Image, warp: Warp) -> tuple[float, int]:
    """Metric and number of samples that it counts, at the first level of a part.

    Read in the event of a lattice of one position, which follows sampling and pyramid and asks no slopes.

    Raises
    ------
    RegframeError
        SimpleITK refuses.
    """
    import SimpleITK as sitk

    part, fixed, moving = _levelled(part, (fixed, moving), warp)
    method = told(part, fixed, moving)
    method.SetMetricUseMovingImageGradientFilter(False)
    seen: list[tuple[float, int]] = []
    method.AddCommand(
        sitk.sitkIterationEvent,
        lambda: seen.append((method.GetMetricValue(), method.GetMetricNumberOfValidPoints())),
    )
    put(method, part, warp)
    if warp.transform.local:
        # Its lattices count axes where they have parameters, and read beyond the end.
        method.SetOptimizerAsGradientDescent(1e-300, 1, -1e300, 100, method.Never)
    else:
        method.SetOptimizerAsExhaustive([0] * len(warp.params), 1.0)
    _execute(method, (fixed, moving))
    value, count = seen[0]
    return (float("inf") if value > LARGEST else value), count


def value(part: Part, fixed: Image, moving: Image, warp: Warp) -> float:
    """Metric at the first level of a part, without its slope where samples are a whole grid.

    Raises
    ------
    RegframeError
        SimpleITK refuses.
    """
    part, fixed, moving = _levelled(part, (fixed, moving), warp)
    level = part.levels[0]
    if level.sampling != "all" or level.smooth > 0:
        return value_and_count(part, fixed, moving, warp)[0]
    method, grid = told(part, fixed, moving), part.setting.domain.coarsen(level.shrink)
    direction = [entry for row in grid.direction for entry in row]
    method.SetVirtualDomain(list(reversed(grid.shape)), grid.origin, grid.spacing, direction)
    put(method, part, warp)
    try:
        with steady():
            found = float(method.MetricEvaluate(*map(convert.image, (fixed, moving))))
    except RuntimeError as error:
        raise translated(error) from None
    return float("inf") if found > LARGEST else found


def derivative(part: Part, fixed: Image, moving: Image, warp: Warp) -> Params:
    """d value / d params, uphill, read from one step of gradient descent.

    A first short step tells how long the second may be: long enough that the position leaves few bits
    behind, and short enough for families whose update is no sum.
    """
    import SimpleITK as sitk

    part, fixed, moving = _levelled(part, (fixed, moving), warp)
    method, counts = told(part, fixed, moving), [1]
    method.SetOptimizerScales([1.0] * (warp.frame.dim if warp.transform.local else len(warp.params)))
    if warp.transform.local and twins.summed(part.stage.metric):
        method.AddCommand(
            sitk.sitkIterationEvent, lambda: counts.append(method.GetMetricNumberOfValidPoints())
        )
    warp = Warp(twins.adding(warp.transform), warp.params, warp.frame)
    slope = np.zeros_like(warp.params)
    rate = 1e-3
    for _ in range(2):
        moved = put(method, part, warp)
        method.SetOptimizerAsGradientDescent(rate, 1, -1e300, 100, method.Never)
        _execute(method, (fixed, moving))
        slope = -twins.step(warp, np.array(moved.GetParameters())) / rate
        steepest = float(np.abs(slope).max())
        if steepest == 0.0:
            break
        rate = 1.0 / steepest
    return slope / counts[-1]


def pushed(part: Part, fixed: Image, moving: Image, warp: Warp) -> tuple[float, Points]:
    """Metric, and its uphill push on each grid point, of a displacement field that moves as a warp does.

    SimpleITK has metrics, the demons, for such fields alone.

    Raises
    ------
    RegframeError
        SimpleITK refuses.
    """
    import SimpleITK as sitk

    grid = fixed.grid
    points = grid.points(Samples(grid.shape).all_indices())
    motion = (warp(points) - points).reshape(*grid.shape, grid.dim)
    field = sitk.GetImageFromArray(np.ascontiguousarray(motion), isVector=True)
    field.CopyInformation(reference(fixed))
    moved = sitk.DisplacementFieldTransform(field)
    method, values = told(part, fixed, moving), []
    method.AddCommand(sitk.sitkIterationEvent, lambda: values.append(method.GetMetricValue()))
    method.SetOptimizerAsGradientDescent(1.0, 1, -1e300, 100, method.Never)
    method.SetInitialTransform(moved, True)
    _execute(method, (fixed, moving))
    after = np.array(moved.GetParameters()).reshape(motion.shape)
    return values[0], (motion - after).reshape(points.shape)


def smoothed(image: Image, sigma: float, unit: str = "physical") -> Image:
    """The image after SimpleITK's recursive Gaussian, as its registration method smooths a level."""
    import SimpleITK as sitk

    if sigma == 0.0:
        return image
    sigmas = [sigma * spacing if unit == "voxels" else sigma for spacing in image.grid.spacing]
    theirs = sitk.SmoothingRecursiveGaussian(convert.image(image), sigmas)
    # The filter gives float32 whatever it is given; the registration method casts back.
    return image.with_rounded(sitk.GetArrayFromImage(theirs))


def resampled(
    image: Image, warp: Warp | Chain, grid: "sitk.Image", name: str, *, double: bool = True
) -> NDArray[np.float64]:
    """Values of an image on a grid through a warp, NaN outside; `double` keeps float64."""
    import SimpleITK as sitk

    kept = sitk.sitkFloat64 if double else convert.image(image).GetPixelID()
    found = sitk.Resample(
        convert.image(image), grid, convert.transform(warp), getattr(sitk, name), float("nan"), kept
    )
    return np.asarray(sitk.GetArrayFromImage(found), np.float64)


def mapped(warp: Warp | Chain, points: Points) -> Points:
    """Moving points of (n, dim) fixed points."""
    theirs = convert.transform(warp)
    return np.array([theirs.TransformPoint(list(map(float, point))) for point in points])


def at_points(image: Image, points: Points, name: str, *, double: bool = True) -> Values:
    """Values of an image at (n, dim) physical points, NaN outside.

    SimpleITK reads points one by one and prefilters the image for each; a field that leads the pixels of
    a thread of an image to the points reads them all at once.
    """
    import SimpleITK as sitk

    dim = image.dim
    thread = sitk.Image([len(points)] + [1] * (dim - 1), sitk.sitkUInt8)
    origins = np.zeros_like(points)
    origins[:, 0] = np.arange(len(points))
    field = np.ascontiguousarray((points - origins).reshape((1,) * (dim - 1) + (len(points), dim)))
    led = sitk.DisplacementFieldTransform(sitk.GetImageFromArray(field, isVector=True))
    theirs = convert.image(image)
    kept = sitk.sitkFloat64 if double else theirs.GetPixelID()
    found = sitk.Resample(theirs, thread, led, getattr(sitk, name), float("nan"), kept)
    return np.asarray(sitk.GetArrayFromImage(found), np.float64).ravel()


def reference(image: Image) -> "sitk.Image":
    """An empty image on the same grid."""
    return array_to_sitk(np.zeros(image.grid.shape, np.uint8), image.grid)


def _levelled(part: Part, pair: tuple[Image, Image], warp: Warp) -> tuple[Part, Image, Image]:
    """A part for a field on its first level's grid: SimpleITK would shrink the field that it is given."""
    if not warp.transform.local:
        return part, *pair
    level, setting = part.levels[0], part.setting
    fixed, moving = (smoothed(image, level.smooth, part.stage.smooth_unit) for image in pair)
    alone = level.model_copy(update={"shrink": 1, "smooth": 0.0})
    here = replace(setting, domain=setting.domain.coarsen(level.shrink))
    return Part(part.stage, (alone,), part.seed, here), fixed, moving


def _execute(method: "Method", pair: tuple[Image, Image]) -> None:
    try:
        with steady():
            method.Execute(*map(convert.image, pair))
    except RuntimeError as error:
        raise translated(error) from None
