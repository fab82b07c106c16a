"""A component with one deliberate fault is caught, and the line that differs names it."""

import numpy as np
import pytest

from regframe.engine.setting import Setting
from regframe.peer import components, pairs
from regframe.peer.bench import Bench
from regframe.preset import Stage
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.planted import Degrees, HalfPixel, Swapped, WrongSign

HONEST = {
    "transform": "similarity",
    "interpolator": "linear",
    "metric": "mean-squares",
    "optimizer": "one-plus-one",
    "levels": [{"shrink": 2, "smooth": 1.0, "iterations": 5}],
}
MAPS = "points mapped by the transform"
VALUES = "interpolated values"
SLOPE = "slope of the metric"
READ = "metric of intensities read by SimpleITK"
TURNED = "metric along angle_rad"


def differing(**changes):
    """What differs of a stage, by both floors of parts."""
    fixed, moving = peer.pair((30, 36))
    stage = Stage(**{**HONEST, **changes})
    warp = Warp(stage.transform, np.array([1.03, 0.05, 1.3, -0.7]), peer.frame(fixed))
    bench = Bench(stage, 1, fixed, moving, warp, Setting(fixed.grid))
    lines = [*components.compare(bench, "")[0], *pairs.compare(bench, "")]
    assert not any(line.verdict == "not comparable" and line.what != SLOPE for line in lines)
    return {line.what for line in lines if line.verdict == "differs"}


@pytest.mark.parametrize("metric", ["mean-squares", "correlation", "mattes"])
def test_honest_components_agree(metric):
    assert differing(metric=metric) == set()


def test_half_a_pixel_in_an_interpolator():
    assert {VALUES, READ} <= differing(interpolator=HalfPixel())


def test_the_sign_of_a_derivative():
    assert differing(metric=WrongSign()) == {SLOPE}


def test_swapped_marginals():
    assert TURNED in differing(metric=Swapped())


def test_the_unit_of_a_parameter():
    found = differing(transform=Degrees())

    assert MAPS in found
    assert READ in found
