"""From evidence to a probability and an expected error, by coefficients that were fitted to known answers.

``python docs/calibration fit`` writes the coefficients from the table of runs beside it; the page
``docs/explanation/verdict.md`` tells what was run and how well it holds on scenes that were kept back.
"""

import json
from functools import cache
from importlib.resources import files
from math import exp, log2
from typing import TYPE_CHECKING

import numpy as np

from regframe.catalog import METRICS
from regframe.geometry import Grid
from regframe.types import Values
from regframe.verdict.evidence import Evidence

if TYPE_CHECKING:
    from regframe.engine.base import Result

GOOD, FAILED = 0.9, 0.2
"""A map is good from this probability on, and failed below that one; between them it is doubtful."""

COVERED = ("mattes", "oriented-gradients")
"""Metrics of the last stage that are judged.

The table's runs used the second. The evidence looks at a map and not at how it was found, so it is taken
to hold for maps of the first too, which a test tries on a street.
"""

SMALLEST = 96
"""Pixels along the shorter side of a frame, from which on frames are in the table."""

NAMES = ("constant", "parts_near", "leftover", "rival", "edge_fit", "round_trip")
"""Of the coefficients; the last one is missing where no second search was made."""

PRIOR = 3.0  # parts that agree with nothing, added so that few parts say little


def features(evidence: Evidence) -> Values:
    """Evidence on scales on which it adds up, each bounded so that no single one decides alone.

    Returns
    -------
    (6,) or, without a second search, (5,) float64
        In the order of `NAMES`; more of `parts_near` and `edge_fit` speaks for a map, the others against it.
    """
    parts = evidence.parts
    found = [
        1.0,
        evidence.parts_near * parts / (parts + PRIOR),
        _octaves(evidence.leftover_px, 1.0, 16.0),
        _octaves(evidence.rival, 0.4, 2.0),
        min(max(evidence.edge_fit, 0.0), 0.4),
    ]
    if evidence.round_trip_px is not None:
        found.append(_octaves(evidence.round_trip_px, 1.0, 16.0))
    return np.array(found)


def probability(evidence: Evidence) -> float:
    """Probability that the map's mean error is within 5 moving pixels."""
    at = features(evidence)
    return 1.0 / (1.0 + exp(-float(at @ coefficients("probability", len(at)))))


def expected_error_px(evidence: Evidence) -> float:
    """The map's expected mean error, in moving pixels."""
    at = features(evidence)
    return float(2.0 ** (at @ coefficients("log2_error", len(at))))


@cache
def coefficients(what: str, count: int) -> Values:
    """The fitted coefficients of ``probability`` or ``log2_error``, with or without a second search."""
    text = files("regframe.verdict").joinpath("coefficients.json").read_text(encoding="utf-8")
    kind = "with_round_trip" if count == len(NAMES) else "without_round_trip"
    table = json.loads(text)[kind][what]
    return np.array([table[name] for name in NAMES[:count]])


def excuse(result: "Result") -> str:
    """Why no calibration holds for a result; empty where one holds."""
    if result.fixed.dim != 2:
        return "no runs on volumes were calibrated"
    if any(image.grid != Grid.of_shape(image.grid.shape) for image in (result.fixed, result.moving)):
        return "only camera frames, whose unit is the pixel, were calibrated"
    smallest = min(min(image.grid.shape) for image in (result.fixed, result.moving))
    if smallest < SMALLEST:
        return f"no frames of less than {SMALLEST} pixels were calibrated, and one here has {smallest}"
    metric = METRICS.name_of(result.preset.stages[-1].metric)
    if metric not in COVERED:
        return f"the calibration does not cover the metric {metric}"
    return ""


def _octaves(value: float, low: float, high: float) -> float:
    """How many times a value doubles the low bound, within bounds."""
    return log2(min(max(value, low), high) / low)
