"""What stays around the map that is searched: the grid of samples, and the maps before and after it."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from regframe.errors import GeometryError
from regframe.geometry import Grid
from regframe.image import Image
from regframe.preset import Level, Stage
from regframe.transforms.warp import Chain, Warp

Map = Warp | Chain


@dataclass(frozen=True, eq=False)
class Placement:
    """What is known of the images' places before a search; each part may be left out.

    A point of the domain lies in the fixed image where `fixed_initial` puts it, and in the moving image
    where the searched map puts it and then `moving_initial`. Only the searched map changes. The result's
    warp is the whole way from the fixed to the moving image.

    Parameters
    ----------
    start : Warp or Chain, optional
        Where the first stage begins, in place of its own `start`.
    moving_initial : Warp or Chain, optional
        Applied after the searched map; without a `start` the first stage begins with no motion before it.
    fixed_initial : Warp or Chain, optional
        Takes points of the domain to the fixed image; it must be affine, so that it can be gone back.
    domain : Grid, optional
        Where samples lie; the fixed image's grid when left out.

    Examples
    --------
    >>> import numpy as np
    >>> from regframe.engine.setting import Placement
    >>> from regframe.geometry import Frame
    >>> from regframe.testing.phantoms import visual_thermal
    >>> from regframe.transforms.translation import Translation
    >>> from regframe.transforms.warp import Warp
    >>> pair = visual_thermal(seed=1, shape=(48, 64))
    >>> known = Warp(Translation(), np.array([-9.0, -7.0]), Frame.about_centre(pair.fixed.grid))
    >>> from regframe import register
    >>> result = register("paper-similarity", pair.fixed, pair.moving, start=Placement(moving_initial=known))
    >>> [type(warp.transform).__name__ for warp in result.warp.warps]
    ['Translation', 'Similarity']
    """

    start: Map | None = None
    moving_initial: Map | None = None
    fixed_initial: Map | None = None
    domain: Grid | None = None

    @classmethod
    def of(cls, start: "Map | Placement | None") -> "Placement":
        """A placement as it is, or one of a start alone."""
        return start if isinstance(start, cls) else cls(start=start)  # type: ignore[arg-type]  # a map or None


@dataclass(frozen=True, eq=False)
class Setting:
    """What stays around a searched map.

    Parameters
    ----------
    domain : Grid
        Where samples lie before a level shrinks it.
    below : Warp or Chain, optional
        From the domain to the fixed image; no motion when left out.
    beyond : Warp or Chain, optional
        From where the searched map leads to the moving image.
    """

    domain: Grid
    below: Map | None = None
    beyond: Map | None = None

    def whole(self, warp: Warp) -> Map:
        """The way from the fixed to the moving image with a searched map in it."""
        return _joined(self.beyond, warp, None if self.below is None else self.below.inverse())

    def onward(self, warp: Map) -> Map:
        """The way from the domain to the moving image."""
        return _joined(self.beyond, warp)

    def entered(self, stage: Stage, before: Map | None) -> "Setting":
        """The setting of a stage that follows a map found `before`."""
        if stage.start == "compose":
            return self if before is None else replace(self, beyond=self.onward(before))
        return self if stage.start == "previous" else replace(self, beyond=None)


def opened(place: Placement, fixed: Image) -> Setting:
    """The setting before the first stage.

    Raises
    ------
    GeometryError
        A domain of other dimensions than the image, a map to the fixed image that is not affine, or a map
        that lays the image on a line.
    """
    domain = fixed.grid if place.domain is None else place.domain
    if domain.dim != fixed.dim:
        message = (
            f"the domain is {domain.dim}-D and {fixed.name} {fixed.dim}-D. Give a grid of the image's axes."
        )
        raise GeometryError(message)
    below = place.fixed_initial
    if below is not None and below.as_affine() is None:
        message = (
            "the fixed-initial map bends, so the way back from the fixed image is not known. Got "
            f"{_named(below)}. Give an affine one, or resample the fixed image through it first."
        )
        raise GeometryError(message)
    for role, one in (("fixed-initial", below), ("moving-initial", place.moving_initial)):
        if one is not None:
            _check_spread(role, one)
    return Setting(domain, below, place.moving_initial)


def _check_spread(role: str, one: Map) -> None:
    affine = one.as_affine()
    if affine is not None:
        try:
            affine.inverse()
        except GeometryError as error:
            message = f"the {role} map lays the image on a line or a point. {error}"
            raise GeometryError(message) from None


def begun(stages: tuple[Stage, ...], place: Placement) -> tuple[Stage, ...]:
    """The stages, the first one taking up what was given."""
    if place.start is not None:
        return (stages[0].model_copy(update={"start": "previous"}), *stages[1:])
    if place.moving_initial is not None:
        return (stages[0].model_copy(update={"start": "compose"}), *stages[1:])
    return stages


def taken_up(warp: Warp, setting: Setting, level: Level) -> Warp:
    """The searched map as a level takes it up: a lattice of its own may be laid anew."""
    grid = setting.domain.coarsen(level.shrink)
    params, frame = warp.transform.adapted(warp.params, warp.frame, grid, level.refine)
    return Warp(warp.transform, params, frame)


def _joined(*maps: Map | None) -> Map:
    warps = tuple(warp for one in maps if one is not None for warp in _members(one))
    return warps[0] if len(warps) == 1 else Chain(warps)


def _members(one: Map) -> Iterator[Warp]:
    yield from one.warps if isinstance(one, Chain) else (one,)


def _named(one: Map) -> str:
    return " and ".join(type(warp.transform).__name__ for warp in _members(one))
