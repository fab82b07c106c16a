"""Where a stage begins: the frame its parameters speak of, and their first values."""

from dataclasses import replace

import numpy as np

from regframe.engine.itk_axes import itk_turn
from regframe.engine.moments import mass_centre, spread, turn_between
from regframe.engine.setting import Setting
from regframe.errors import GeometryError
from regframe.geometry import AffineMap, Frame, Grid
from regframe.image import Image
from regframe.preset import Search, Stage
from regframe.transforms.linear import about
from regframe.transforms.warp import Chain, Warp
from regframe.types import Params

BY_MASS = ("moments", "principal-axes", "itk-principal-axes")
"""Starts that take the centre of mass for the centre."""


def begin(
    stage: Stage, fixed: Image, moving: Image, before: Warp | Chain | None, setting: Setting | None = None
) -> Warp:
    """The stage's first warp; before a search, the middle of what it looks at.

    Parameters
    ----------
    stage : Stage
    fixed, moving : Image
        After their filters.
    before : Warp or Chain or None
        What the stage before found, or a start given by the user.
    setting : Setting, optional
        What stays around the map, when it is not the fixed image's grid alone.

    Raises
    ------
    GeometryError
        The transform cannot represent the start.
    ImageError
        Centres of mass of an image without mass.
    """
    setting = setting or Setting(fixed.grid)
    transform, frame = stage.transform, Frame.about_centre(setting.domain, moving.grid)
    if stage.start == "previous" and before is not None:
        return _continued(stage, before, moving)
    if stage.start in ("identity", "compose"):
        return Warp(transform, transform.identity(frame), frame)
    unit, centre = np.eye(fixed.dim), fixed.grid.centre
    if stage.start in BY_MASS:
        centre = mass_centre(fixed)
        shift = mass_centre(moving) - centre
    else:
        shift = moving.grid.centre - centre
    if stage.start == "fields-of-view":
        unit = unit * (moving.grid.extent[0] / fixed.grid.extent[0])
    if isinstance(stage.start, Search):
        unit = unit * base_scale(stage.start, fixed.grid, moving.grid)
    if stage.start == "principal-axes":
        unit = turn_between(fixed, moving)
    if stage.start == "itk-principal-axes":
        unit = itk_turn((fixed, spread(fixed)), (moving, spread(moving)))
    first = about(unit, shift, centre)
    if setting.below is not None:
        first, centre = _behind(setting.below, first, centre)
    if stage.start in BY_MASS:
        frame = replace(frame, centre=centre)
    return Warp(transform, transform.from_affine(first, frame), frame)


def placed_on(stage: Stage, first: AffineMap, moving: Grid, setting: Setting) -> Warp:
    """A map from the fixed to the moving image as a member of the stage's family over the domain."""
    frame = Frame.about_centre(setting.domain, moving)
    if setting.below is not None:
        first, _ = _behind(setting.below, first, frame.centre)
    return Warp(stage.transform, stage.transform.from_affine(first, frame), frame)


def base_scale(options: Search, fixed: Grid, moving: Grid) -> float:
    """Moving over fixed lengths at a search's scale 1."""
    if options.relative_to == "spacing":
        return 1.0
    ratio = float(moving.extent[0] / fixed.extent[0])
    if options.fields_of_view_deg is None:
        return ratio
    below, above = np.tan(np.deg2rad(options.fields_of_view_deg) / 2)
    return ratio * float(below / above)


def _behind(below: Warp | Chain, first: AffineMap, centre: Params) -> tuple[AffineMap, Params]:
    """A map of the fixed image, and a point of it, as they are seen from the domain."""
    onto = below.as_affine()
    assert onto is not None  # a setting is refused otherwise
    return first @ onto, np.asarray(onto.inverse()(centre[None])[0])


def _continued(stage: Stage, before: Warp | Chain, moving: Image) -> Warp:
    """The earlier map as a member of this stage's family, about the same centre."""
    frame = replace(before.frame, moving=moving.grid)
    # Equal options, not only the same class: another mesh or order gives the same numbers another meaning.
    if isinstance(before, Warp) and before.transform == stage.transform:
        return Warp(stage.transform, before.params, frame)
    frame = replace(frame, lattice=None)
    if stage.transform.local:
        points = frame.grid.points(frame.grid.all_indices())
        return Warp(stage.transform, (before(points) - points).ravel(), frame)
    affine, straight = before.as_affine(), before.as_homogeneous()
    if affine is not None:
        return Warp(stage.transform, stage.transform.from_affine(affine, frame), frame)
    if straight is None:
        message = (
            f"{type(stage.transform).__name__} cannot continue a map that bends. Put this stage first, "
            "or begin it with another `start`."
        )
        raise GeometryError(message)
    return Warp(stage.transform, stage.transform.from_homogeneous(straight, frame), frame)
