"""A preset of stubs, which changes only when a test changes it."""

from copy import deepcopy

import pytest

from regframe.catalog import FILTERS, METRICS
from regframe.preset import Preset, parse
from support.stubs import GridStub, Same, Stub

TREE = {
    "name": "base",
    "about": "Of stubs.",
    "seed": 3,
    "filters": {"fixed": [], "moving": ["stub"]},
    "stages": [
        {
            "transform": "similarity",
            "interpolator": {"type": "bspline", "order": 2},
            "metric": {"type": "stub", "bins": 32},
            "optimizer": "one-plus-one",
            "levels": [{"shrink": 2, "smooth": 1.5}, {}],
        }
    ],
}


@pytest.fixture(autouse=True)
def stubs():
    """Two metrics and a filter by name."""
    FILTERS.register("stub")(Same)
    METRICS.register("stub")(Stub)
    METRICS.register("grid-stub")(GridStub)
    yield
    METRICS.forget("stub")
    METRICS.forget("grid-stub")
    FILTERS.forget("stub")


@pytest.fixture
def tree() -> dict:
    """Tables and lists of a preset, free to change."""
    return deepcopy(TREE)


@pytest.fixture
def base(tree) -> Preset:
    """The preset of the tree."""
    return parse(tree)
