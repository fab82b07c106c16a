"""Image registration from replaceable parts: the public names, loaded when first used."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from regframe.catalog import FILTERS, INTERPOLATORS, METRICS, OPTIMIZERS, TRANSFORMS
    from regframe.engine.base import Engine, LevelReport, Progress, Result
    from regframe.engine.resampling import align
    from regframe.engine.run import register
    from regframe.engine.setting import Placement
    from regframe.errors import (
        GeometryError,
        ImageError,
        MissingExtra,
        NoOverlapError,
        NoTwin,
        OutputError,
        PresetError,
        RegframeError,
    )
    from regframe.filters.base import Filter
    from regframe.geometry import AffineMap, Frame, Grid
    from regframe.image import Image
    from regframe.interpolators.base import Interpolator, Samples
    from regframe.io import read, read_mask, write
    from regframe.metrics.base import Metric, Pairs
    from regframe.optimizers.base import Optimizer, Problem, Step
    from regframe.peer.crosscheck import crosscheck
    from regframe.peer.report import Report
    from regframe.preset import Level, Preset, Stage
    from regframe.preset import load as load_preset
    from regframe.transforms.base import Transform
    from regframe.transforms.warp import Chain, Warp

__version__ = "0.1.0"

__all__ = [
    "FILTERS",
    "INTERPOLATORS",
    "METRICS",
    "OPTIMIZERS",
    "TRANSFORMS",
    "AffineMap",
    "Chain",
    "Engine",
    "Filter",
    "Frame",
    "GeometryError",
    "Grid",
    "Image",
    "ImageError",
    "Interpolator",
    "Level",
    "LevelReport",
    "Metric",
    "MissingExtra",
    "NoOverlapError",
    "NoTwin",
    "Optimizer",
    "OutputError",
    "Pairs",
    "Placement",
    "Preset",
    "PresetError",
    "Problem",
    "Progress",
    "RegframeError",
    "Report",
    "Result",
    "Samples",
    "Stage",
    "Step",
    "Transform",
    "Warp",
    "__version__",
    "align",
    "crosscheck",
    "load_preset",
    "read",
    "read_mask",
    "register",
    "write",
]

_PLACES = {
    "AffineMap": "geometry:AffineMap",
    "Chain": "transforms.warp:Chain",
    "Engine": "engine.base:Engine",
    "FILTERS": "catalog:FILTERS",
    "Filter": "filters.base:Filter",
    "Frame": "geometry:Frame",
    "GeometryError": "errors:GeometryError",
    "Grid": "geometry:Grid",
    "INTERPOLATORS": "catalog:INTERPOLATORS",
    "Image": "image:Image",
    "ImageError": "errors:ImageError",
    "Interpolator": "interpolators.base:Interpolator",
    "Level": "preset:Level",
    "LevelReport": "engine.base:LevelReport",
    "METRICS": "catalog:METRICS",
    "Metric": "metrics.base:Metric",
    "MissingExtra": "errors:MissingExtra",
    "NoOverlapError": "errors:NoOverlapError",
    "NoTwin": "errors:NoTwin",
    "OPTIMIZERS": "catalog:OPTIMIZERS",
    "Optimizer": "optimizers.base:Optimizer",
    "OutputError": "errors:OutputError",
    "Pairs": "metrics.base:Pairs",
    "Placement": "engine.setting:Placement",
    "Preset": "preset:Preset",
    "PresetError": "errors:PresetError",
    "Problem": "optimizers.base:Problem",
    "Progress": "engine.base:Progress",
    "RegframeError": "errors:RegframeError",
    "Report": "peer.report:Report",
    "Result": "engine.base:Result",
    "Samples": "interpolators.base:Samples",
    "Stage": "preset:Stage",
    "Step": "optimizers.base:Step",
    "TRANSFORMS": "catalog:TRANSFORMS",
    "Transform": "transforms.base:Transform",
    "Warp": "transforms.warp:Warp",
    "align": "engine.resampling:align",
    "crosscheck": "peer.crosscheck:crosscheck",
    "load_preset": "preset:load",
    "read": "io:read",
    "read_mask": "io:read_mask",
    "register": "engine.run:register",
    "write": "io:write",
}


def __getattr__(name: str) -> object:
    if name not in _PLACES:
        message = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(message)
    module, _, attribute = _PLACES[name].partition(":")
    value = getattr(import_module(f"{__name__}.{module}"), attribute)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
