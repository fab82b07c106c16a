"""Sums of metrics: what they add up, and how presets say it."""

from dataclasses import replace

import numpy as np
import pytest

from regframe import preset
from regframe.catalog import METRICS
from regframe.engine.run import register
from regframe.errors import PresetError
from regframe.testing.metric_checks import example_pairs, prepared
from regframe.testing.phantoms import smooth_pair

MIXED = {"type": "sum", "parts": ["ants-correlation", {"type": "mattes", "bins": 20}], "weights": [2.0, 0.5]}


def stage(metric, **level):
    return {
        "transform": "translation",
        "interpolator": "linear",
        "metric": metric,
        "optimizer": "one-plus-one",
        "levels": [level],
    }


def test_adds_what_its_parts_say():
    whole, pairs = METRICS.build(MIXED), example_pairs(shift=(0, 2))

    value, slopes = whole.value_and_derivative(prepared(whole, pairs))

    alone = [part.value_and_derivative(prepared(part, pairs)) for part in whole.parts]
    assert value == pytest.approx(2.0 * alone[0][0] + 0.5 * alone[1][0], rel=1e-15)
    np.testing.assert_allclose(slopes, 2.0 * alone[0][1] + 0.5 * alone[1][1], rtol=1e-15)


def test_without_weights_each_part_counts_one():
    plain, ones = (
        METRICS.build({"type": "sum", "parts": ["mattes", "correlation"], **more})
        for more in ({}, {"weights": [1.0, 1.0]})
    )
    pairs = example_pairs()

    assert plain.value(prepared(plain, pairs)) == ones.value(prepared(ones, pairs))


def test_wants_grids_if_a_part_does():
    loose = METRICS.build({"type": "sum", "parts": ["mattes", "correlation"]})
    nested = METRICS.build({"type": "sum", "parts": ["mattes", MIXED]})

    assert [loose.layout, METRICS.build(MIXED).layout, nested.layout] == ["points", "grid", "grid"]


def test_a_part_that_wants_grids_refuses_sparse_sampling():
    with pytest.raises(PresetError, match=r"levels.0.sampling: the metric 'sum' needs neighbourhoods"):
        preset.parse({"stages": [stage(MIXED, sampling="random", fraction=0.2)]})


def test_loose_parts_take_sparse_samples():
    phantom = smooth_pair("mono", (40, 44), seed=1)
    loose = {"type": "sum", "parts": ["mattes", "mean-squares"], "weights": [1.0, 0.01]}

    result = register(
        {"stages": [stage(loose, sampling="random", fraction=0.3, iterations=20)]},
        phantom.fixed,
        phantom.moving,
    )

    assert result.value <= result.levels[0].start_value


def test_has_no_slope_if_a_part_has_none():
    whole = METRICS.build({"type": "sum", "parts": ["mattes", "joint-histogram-mi"]})
    pairs = prepared(whole, example_pairs())

    assert whole.derivative(pairs) is None
    assert whole.value_and_derivative(pairs)[0] == whole.value(pairs)


def test_suits_what_all_parts_suit():
    assert METRICS.build({"type": "sum", "parts": ["mattes", "correlation"]}).suits == ("mono", "inverted")


def test_is_infinite_where_a_part_is():
    whole = METRICS.build(MIXED)
    pairs = example_pairs()

    nothing = replace(pairs, weight=np.zeros_like(pairs.weight))

    assert whole.value(prepared(whole, nothing)) == float("inf")


def test_survives_a_preset_file(tmp_path):
    whole = preset.parse({"stages": [stage(MIXED)]})

    preset.save(whole, tmp_path / "sum.toml")

    assert preset.load(tmp_path / "sum.toml") == whole


@pytest.mark.parametrize(
    ("broken", "said"),
    [
        ({"weights": [1.0]}, r"stages\.0\.metric\.weights: must be as many as the parts, 2\. Got 1"),
        ({"weights": [1.0, 0.0]}, r"stages\.0\.metric\.weights\.1: .*greater than 0"),
        ({"parts": []}, r"stages\.0\.metric\.parts"),
        ({"parts": ["mates"]}, r"stages\.0\.metric\.parts\.0: no metric is called 'mates'.*mattes"),
        (
            {"parts": ["mattes", {"type": "mattes", "bin": 3}]},
            r"stages\.0\.metric\.parts\.1\.bin: .*Did you mean 'bins'",
        ),
    ],
)
def test_faults_are_told_with_their_place(broken, said):
    with pytest.raises(PresetError, match=said):
        preset.parse({"stages": [stage({**MIXED, **broken})]})
