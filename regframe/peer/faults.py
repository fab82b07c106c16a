"""SimpleITK's errors as ours, in one line."""

import re

from regframe.errors import ImageError, NoOverlapError, RegframeError

_CLUTTER = re.compile(r"^(ITK ERROR: |sitk::ERROR: )|\w+\(0x[0-9a-f]+\): ")
_PLACE = re.compile(r"^Exception thrown in SimpleITK")
_NOTHING_MET = ("All samples map outside", "No valid points", "VirtualSampledPointSet must have 1 or more")
_FLAT = ("zero-valued spacing", "spacing of zero", "Zero-valued spacing")


def translated(error: RuntimeError) -> RegframeError:
    r"""The error of ours that an error of SimpleITK's means.

    Examples
    --------
    >>> translated(RuntimeError("Exception thrown in SimpleITK X: a.hxx:1:\nITK ERROR: Y(0x1f): odd"))
    RegframeError('SimpleITK cannot run this: odd. Change that part of the preset, or use the native engine.')
    """
    lines = [_CLUTTER.sub("", line).strip() for line in str(error).splitlines() if not _PLACE.match(line)]
    told = " ".join(line for line in lines if line).rstrip(". ") or "no reason given"
    if any(sign in told for sign in _NOTHING_MET):
        message = (
            "The images share nothing to compare (SimpleITK found no valid sample). Check the masks and "
            "geometry, begin nearer with `start`, or take smaller steps."
        )
        return NoOverlapError(message)
    if any(sign in told for sign in _FLAT):
        message = (
            f"SimpleITK cannot compare these images: one is constant where they meet ({told}). "
            "Check the masks."
        )
        return ImageError(message)
    return RegframeError(
        f"SimpleITK cannot run this: {told}. Change that part of the preset, or use the native engine."
    )
