"""Twins: who has one, who may add one, and what a missing one says."""

import numpy as np
import pytest

import regframe
from regframe.errors import NoTwin
from regframe.geometry import Frame, Grid
from regframe.interpolators.base import Interpolator
from regframe.metrics.base import Metric
from regframe.optimizers.base import Optimizer
from regframe.optimizers.one_plus_one import OnePlusOne
from regframe.peer import (
    shipped,  # noqa: F401  # registers the twins
    twins,
)
from regframe.preset import Stage
from regframe.transforms.base import Transform
from support import sitk as peer


class Lonely(Metric):
    def value(self, pairs):
        return 0.0


class LonelyWay(Interpolator):
    def sample(self, coefficients, indices):
        return np.zeros(len(indices))


class LonelyMap(Transform):
    def identity(self, frame):
        return np.zeros(1)

    def map(self, params, points, frame):
        return points


class LonelySearch(Optimizer):
    def steps(self, problem, start, rng):
        yield from ()
        return ""


FRAME = Frame.about_centre(Grid.of_shape((5, 6)))


@pytest.mark.parametrize(
    ("ask", "name"),
    [
        (lambda: twins.metric(Lonely(), None), "Lonely"),
        (lambda: twins.interpolator(LonelyWay()), "LonelyWay"),
        (lambda: twins.transform(LonelyMap(), FRAME), "LonelyMap"),
        (lambda: twins.optimizer(LonelySearch(), None, 1, 1), "LonelySearch"),
    ],
)
def test_a_missing_twin_says_what_to_do(ask, name):
    with pytest.raises(NoTwin, match=f"{name}.*Those with one.*register"):
        ask()


def test_steps_in_pixels_need_a_word_on_what_they_are():
    stage = Stage(
        transform="affine", interpolator="linear", metric="mattes", optimizer=LonelySearch(), scales="shift"
    )

    with pytest.raises(NoTwin, match="LonelySearch does not say"):
        twins.terms(stage.optimizer, stage, np.ones(6))


def test_a_plugin_registers_its_own():
    class Mine(Metric):
        def value(self, pairs):
            return float("nan")

    @twins.metric.register(Mine)
    def _(_ours, method):
        method.SetMetricAsMeanSquares()

    fixed, moving = peer.pair((24, 28))
    stage = {
        "transform": "translation",
        "interpolator": "linear",
        "metric": "my-own",
        "optimizer": "one-plus-one",
        "levels": [{"iterations": 3}],
    }
    regframe.METRICS.register("my-own")(Mine)
    try:
        result = regframe.register({"stages": [stage]}, fixed, moving, engine="simpleitk")
    finally:
        regframe.METRICS.forget("my-own")

    assert np.isfinite(result.value)


def test_motion_is_told_as_itks_scales():
    stage = Stage(transform="similarity", interpolator="linear", metric="mattes", optimizer=OnePlusOne())
    unit = np.array([40.0, 41.0, 1.0, 1.0])

    told = twins.terms(stage.optimizer, stage, unit)

    assert told.stage.scales == (40.0, 41.0, 1.0, 1.0)
    assert told.alike
    assert "epsilon" in told.notes[0]
