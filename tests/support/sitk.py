"""SimpleITK's side of a comparison: the same images, transforms and metrics, set up once."""

import numpy as np
import SimpleITK as sitk

from regframe.geometry import Frame, Grid
from regframe.image import Image
from regframe.peer.convert import image, transform
from regframe.peer.convert import mask as of_mask
from regframe.transforms.warp import Warp

WINDOWS = ("hamming", "cosine", "welch", "lanczos", "blackman")
INTERPOLATORS = (
    {
        "nearest": sitk.sitkNearestNeighbor,
        "linear": sitk.sitkLinear,
        "gaussian": sitk.sitkGaussian,
        "label-gaussian": sitk.sitkLabelGaussian,
    }
    | {f"bspline{order}": getattr(sitk, f"sitkBSpline{order}") for order in range(1, 6)}
    | {f"{window}-sinc": getattr(sitk, f"sitk{window.capitalize()}WindowedSinc") for window in WINDOWS}
)


def mask(ours: Image) -> sitk.Image:
    return of_mask(ours.mask, ours.grid)


def method(fixed: Image, moving: Image, interpolator: str) -> sitk.ImageRegistrationMethod:
    """A registration method with the images' masks; the metric is Mattes with 50 bins until set."""
    theirs = sitk.ImageRegistrationMethod()
    theirs.SetInterpolator(INTERPOLATORS[interpolator])
    theirs.SetMetricAsMattesMutualInformation(50)
    if fixed.mask is not None:
        theirs.SetMetricFixedMask(mask(fixed))
    if moving.mask is not None:
        theirs.SetMetricMovingMask(mask(moving))
    return theirs


def value_and_count(
    theirs: sitk.ImageRegistrationMethod, fixed: Image, moving: Image, warp: Warp
) -> tuple[float, int]:
    """Metric and number of valid points, read in the event of a step of no length.

    MetricEvaluate leaves no count behind: asking for it ends the process.
    """
    seen: list[tuple[float, int]] = []
    theirs.SetOptimizerAsGradientDescent(1e-300, 1, -1e300, 100, theirs.Never)
    theirs.SetInitialTransform(transform(warp), True)
    theirs.AddCommand(
        sitk.sitkIterationEvent,
        lambda: seen.append((theirs.GetMetricValue(), theirs.GetMetricNumberOfValidPoints())),
    )
    theirs.Execute(image(fixed), image(moving))
    return seen[0]


def derivative(theirs: sitk.ImageRegistrationMethod, fixed: Image, moving: Image, warp: Warp, rate: float):
    """d value / d params (uphill), read from one gradient-descent step; see the reference, 2.11."""
    moved = transform(warp)
    theirs.SetOptimizerAsGradientDescent(rate, 1, -1e300, 100, theirs.Never)
    theirs.SetOptimizerScales([1.0] * len(warp.params))
    theirs.SetInitialTransform(moved, True)
    theirs.Execute(image(fixed), image(moving))
    return -(np.array(moved.GetParameters()) - warp.params) / rate


def textured(shape: tuple[int, ...], seed: int, *, levels: int = 0) -> np.ndarray:
    """A smooth random image in 0 ... 255, rounded to whole grey levels where asked."""
    rng = np.random.default_rng(seed)
    coarse = rng.normal(size=tuple(max(n // 6, 3) for n in shape))
    zoomed = np.zeros(shape)
    for octave in range(2):
        part = rng.normal(size=tuple(max(n // (8 // (octave + 1)), 3) for n in shape)) if octave else coarse
        grids = np.meshgrid(
            *(np.linspace(0, m - 1, n) for m, n in zip(part.shape, shape, strict=True)), indexing="ij"
        )
        low = [np.floor(g).astype(int) for g in grids]
        t = [g - lo for g, lo in zip(grids, low, strict=True)]
        for corner in np.ndindex(*(2,) * len(shape)):
            index = tuple(np.minimum(lo + c, m - 1) for lo, c, m in zip(low, corner, part.shape, strict=True))
            weight = np.prod([tt if c else 1 - tt for tt, c in zip(t, corner, strict=True)], axis=0)
            zoomed += weight * part[index] / (octave + 1)
    scaled = (zoomed - zoomed.min()) / np.ptp(zoomed) * 255.0
    return np.round(scaled) if levels else scaled


def pair(
    shape: tuple[int, ...] = (48, 60),
    dtype: type = np.float32,
    *,
    levels: int = 256,
    grid: Grid | None = None,
) -> tuple[Image, Image]:
    """Two related images with whole grey levels."""
    fixed = textured(shape, 1, levels=levels)
    moving = 255.0 - 0.6 * fixed + 0.3 * textured(shape, 2)
    if levels:
        moving = np.round(moving)
    place = grid or Grid.of_shape(shape)
    return (
        Image(fixed.astype(dtype), place, name="fixed"),
        Image(moving.astype(dtype), place, name="moving"),
    )


def frame(ours: Image) -> Frame:
    return Frame.about_centre(ours.grid)
