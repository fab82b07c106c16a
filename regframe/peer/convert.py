"""Images, masks and warps as SimpleITK has them."""

from typing import TYPE_CHECKING

import numpy as np

from regframe.geometry import Frame, Grid
from regframe.image import Image
from regframe.io.convert import array_to_sitk
from regframe.peer import (
    shipped,  # noqa: F401  # registers the twins
    twins,
    walks,  # noqa: F401  # the same
)
from regframe.transforms.warp import Chain, Warp
from regframe.types import Mask

if TYPE_CHECKING:
    import SimpleITK as sitk


def same_type(fixed: Image, moving: Image) -> tuple[Image, Image]:
    """Both images in one float type: SimpleITK takes no pair of float32 and float64."""
    if fixed.values.dtype == moving.values.dtype:
        return fixed, moving
    wide = (np.asarray(image.values, np.float64) for image in (fixed, moving))
    return tuple(image.with_values(values) for image, values in zip((fixed, moving), wide, strict=True))  # type: ignore[return-value]  # two of them


def image(ours: Image) -> "sitk.Image":
    """The same values, type and geometry."""
    return array_to_sitk(ours.values, ours.grid)


def mask(ours: Mask, grid: Grid) -> "sitk.Image":
    """A mask as the image of ones and zeros that SimpleITK wants."""
    return array_to_sitk(ours.astype(np.uint8), grid)


def transform(warp: Warp | Chain) -> "sitk.Transform":
    """SimpleITK's transform with the same parameters about the same centre; of a chain a composite one.

    Raises
    ------
    NoTwin
    """
    import SimpleITK as sitk

    if isinstance(warp, Chain):
        return sitk.CompositeTransform([transform(one) for one in warp.warps])
    theirs = twins.transform(warp.transform, warp.frame)
    theirs.SetParameters(list(map(float, warp.params)))
    return theirs


def centred(warp: Warp | Chain, frame: Frame) -> "sitk.Transform":
    """A map for SimpleITK to apply after the searched one, its affine members written about another centre.

    SimpleITK sets the searched transform's centre to that of a map applied after it, which changes the
    searched map. About the same centre there is nothing to change.
    """
    import SimpleITK as sitk

    if isinstance(warp, Chain):
        return sitk.CompositeTransform([centred(one, frame) for one in warp.warps])
    affine = warp.as_affine()
    return transform(warp if affine is None else Warp.of_affine(affine, frame))
