"""Where a registration began, for the pictures called "before"."""

from regframe.engine.base import Result
from regframe.engine.native import filtered
from regframe.engine.start import begin
from regframe.transforms.warp import Chain, Warp


def first_warp(result: Result) -> Warp | Chain:
    """The map the first stage started from, made again where an engine does not tell it."""
    if result.start is not None:
        return result.start
    stage, pair = result.preset.stages[0], (result.fixed, result.moving)
    if stage.start == "moments":
        # Only centres of mass depend on what the filters did.
        pair = filtered(result.preset, *pair)
    return begin(stage, *pair, None)
