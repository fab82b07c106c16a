"""The same preset run by either engine."""

from regframe.engine.base import Result
from regframe.engine.native import Native
from regframe.engine.setting import Placement
from regframe.image import Image
from regframe.optimizers.base import Optimizer
from regframe.peer import twins
from regframe.peer.simpleitk import SimpleITKEngine
from regframe.peer.twins import Method
from regframe.peer.whole import finished
from regframe.preset import Preset


def both(
    preset: Preset, fixed: Image, moving: Image, place: Placement | None = None
) -> tuple[Result, Result]:
    """Ours and SimpleITK's result of a preset that says everything in ITK's terms."""
    theirs = finished(SimpleITKEngine(), preset, (fixed, moving), (), place)
    return finished(Native(), preset, (fixed, moving), (), place), theirs


def tell_optimizer(theirs: Method, ours: Optimizer, iterations: int, longest: float | None = None) -> None:
    """Set SimpleITK's optimizer as one of ours, with another largest step where one is given."""
    changes = {"maximum_step": longest} if longest else {}
    twins.optimizer(ours.model_copy(update=changes), theirs, iterations, 1)
