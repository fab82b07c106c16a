"""The same search from the moving image to the fixed one: an answer that knows nothing of the first."""

from typing import TYPE_CHECKING

from regframe.engine.native import found
from regframe.errors import RegframeError
from regframe.preset import Preset, Search, Stage
from regframe.preset.model import Filters
from regframe.transforms.warp import Chain, Warp

if TYPE_CHECKING:
    from regframe.engine.base import Result


ENOUGH = 2  # levels


def searches(preset: Preset) -> bool:
    """Whether a preset looks everywhere first, so that a second run is a second opinion."""
    return isinstance(preset.stages[0].start, Search)


def search(result: "Result") -> Warp | Chain | None:
    """What a result's preset finds from its moving to its fixed image; None where it finds nothing."""
    try:
        return found(turned(result.preset), result.moving, result.fixed)
    except RegframeError:
        return None


def turned(preset: Preset) -> Preset:
    """The preset for exchanged images: each keeps its filters, and the bounds hold for the inverse map.

    Stages of three levels or more leave out the last one, which takes the most time and moves the answer by a
    fraction of the pixels that a verdict is about. A quarter fewer places go on, as a verdict should cost no
    more than what it is about.
    """
    filters = Filters(fixed=preset.filters.moving, moving=preset.filters.fixed)
    stages = tuple(_turned(stage) for stage in preset.stages)
    return preset.model_copy(update={"filters": filters, "stages": stages})


def _turned(stage: Stage) -> Stage:
    start = stage.start
    if len(stage.levels) > ENOUGH:
        stage = stage.model_copy(update={"levels": stage.levels[:-1]})
    if not isinstance(start, Search):
        return stage
    low, high = start.scale
    views = start.fields_of_view_deg
    changes = {
        "scale": (1.0 / high, 1.0 / low),
        "fields_of_view_deg": views and (views[1], views[0]),
        "keep": tuple(-(-most * 3 // 4) for most in start.keep),
    }
    return stage.model_copy(update={"start": start.model_copy(update=changes)})
