"""The whole experiment as data: what is done to two images, in which order, with which options."""

from regframe.preset.files import as_toml, load, parse, save, setting
from regframe.preset.finding import faults, folder, names, origin, shipped
from regframe.preset.model import Filters, Level, Preset, Stage, dump
from regframe.preset.paths import differences
from regframe.preset.schema import schema
from regframe.preset.search import Search

__all__ = [
    "Filters",
    "Level",
    "Preset",
    "Search",
    "Stage",
    "as_toml",
    "differences",
    "dump",
    "faults",
    "folder",
    "load",
    "names",
    "origin",
    "parse",
    "save",
    "schema",
    "setting",
    "shipped",
]
