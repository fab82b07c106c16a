"""The errors regframe raises on purpose, each telling what was wrong, the value met and what to do."""


class RegframeError(Exception):
    """Root of every error that regframe raises on purpose."""


class PresetError(RegframeError):
    """A preset, or a component in it, is not what it must be."""


class ImageError(RegframeError):
    """An image cannot be read, or its pixels cannot be registered."""


class GeometryError(RegframeError):
    """Grids, masks, dimensions or transforms do not fit together."""


class NoOverlapError(RegframeError):
    """Fixed and moving image share no sample under the current transform."""


class OutputError(RegframeError):
    """A result cannot be written where it was asked for."""


class MissingExtra(RegframeError):
    """An optional package is needed; the message holds its install line."""


class NoTwin(RegframeError):
    """A component has no counterpart in the other engine."""
