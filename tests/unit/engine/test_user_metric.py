"""A metric of a user's own: fifteen lines, value only, chosen by name."""

import numpy as np
import pytest
from pydantic import Field

from regframe import METRICS, Metric, Pairs
from regframe.engine.native import Native
from regframe.preset import parse
from support import sitk as peer


class CorrelationRatio(Metric):
    """Share of moving variance that fixed intensity does not explain (Roche et al., 1998)."""

    bins: int = Field(64, ge=4, description="Classes of fixed intensity.")

    def value(self, pairs: Pairs) -> float:
        low, high = pairs.fixed_range
        label = np.clip((pairs.fixed - low) / (high - low) * self.bins, 0, self.bins - 1).astype(int)
        mass, first, second = (
            np.bincount(label, pairs.weight * pairs.moving**k, self.bins) for k in range(3)
        )
        within = second.sum() - (first**2 / np.maximum(mass, 1e-12)).sum()
        return float(within / (second.sum() - first.sum() ** 2 / mass.sum()))


@pytest.fixture
def named():
    METRICS.register("my-ratio")(CorrelationRatio)
    yield "my-ratio"
    METRICS.forget("my-ratio")


@pytest.mark.parametrize("optimizer", ["one-plus-one", "regular-step-gradient-descent"])
def test_runs_by_name_with_masks_pyramid_and_either_optimizer(named, optimizer):
    fixed, moving = peer.pair((90, 110))
    shifted = moving.with_values(np.roll(moving.values, (3, -4), axis=(0, 1)))
    y, x = np.indices(fixed.grid.shape)
    fixed = fixed.with_mask((x > 10) & (x < 100) & (y > 10) & (y < 80))
    shifted = shifted.with_mask(y < 88)
    stage = {
        "transform": "translation",
        "interpolator": "linear",
        "metric": {"type": named, "bins": 32},
        "optimizer": optimizer,
        "levels": [{"shrink": 2, "smooth": 1.0, "iterations": 80}, {"iterations": 80}],
    }

    steps = Native().iterate(parse({"name": "test", "stages": [stage]}), fixed, shifted)
    result = _last(steps)

    assert np.linalg.norm(result.warp.params - [-4, 3]) < 0.25
    assert result.preset.stages[0].metric.bins == 32


def _last(steps):
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value
