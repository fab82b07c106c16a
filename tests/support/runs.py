"""The same preset run by either engine."""

from regframe.engine.base import Result
from regframe.engine.native import Native
from regframe.image import Image
from regframe.peer.simpleitk import SimpleITKEngine
from regframe.peer.whole import finished
from regframe.preset import Preset


def both(preset: Preset, fixed: Image, moving: Image) -> tuple[Result, Result]:
    """Ours and SimpleITK's result of a preset that says everything in ITK's terms."""
    theirs = finished(SimpleITKEngine(), preset, (fixed, moving))
    assert theirs.provenance["notes"] == []
    return finished(Native(), preset, (fixed, moving)), theirs
