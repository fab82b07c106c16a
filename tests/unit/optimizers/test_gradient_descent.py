"""Gradient descent: its steps, learning rates, convergence and what it keeps."""

import numpy as np
import pytest

from regframe.catalog import OPTIMIZERS
from regframe.errors import NoOverlapError, PresetError
from regframe.optimizers.convergence import Window
from regframe.optimizers.gradient_descent import GradientDescent
from support.problems import Bowl, run

FIXED = {"estimate_learning_rate": "never", "learning_rate": 0.1}


def test_steps_are_as_long_as_the_slope_is_steep():
    optimizer = GradientDescent(keep="last", **FIXED)

    steps, _ = run(optimizer, Bowl([10.0, 0.0]), [0.0, 0.0], iterations=2)

    np.testing.assert_allclose([s.params for s in steps], [[2.0, 0.0], [3.6, 0.0]], rtol=1e-15)
    assert [s.value for s in steps] == [100.0, 64.0]  # where each step began
    assert [s.size for s in steps] == pytest.approx([2.0, 1.6])


def test_scales_divide_the_slope():
    optimizer = GradientDescent(keep="last", **FIXED)

    steps, _ = run(optimizer, Bowl([10.0, 10.0], scales=[4.0, 0.5]), [0.0, 0.0], iterations=1)

    np.testing.assert_allclose(steps[0].params, [0.5, 4.0], rtol=1e-15)


@pytest.mark.parametrize(
    ("when", "sizes"), [("never", [2.0, 1.6]), ("once", [3.0, 2.1]), ("each-iteration", [3.0, 3.0])]
)
def test_estimates_its_learning_rate_when_told(when, sizes):
    optimizer = GradientDescent(estimate_learning_rate=when, learning_rate=0.1, maximum_step=3.0)

    steps, _ = run(optimizer, Bowl([10.0, 0.0]), [0.0, 0.0], iterations=2)

    assert [s.size for s in steps] == pytest.approx(sizes)


def test_stops_when_the_value_no_longer_falls():
    steps, reason = run(GradientDescent(**FIXED), Bowl([3.0, 1.0]), [0.0, 0.0])

    assert "convergence_minimum (1e-06)" in reason
    np.testing.assert_allclose(steps[-1].params, [3.0, 1.0], atol=0.02)


def test_a_negative_minimum_goes_on():
    optimizer = GradientDescent(convergence_minimum=-1e300, **FIXED)

    steps, reason = run(optimizer, Bowl([3.0, 1.0]), [0.0, 0.0], iterations=200)

    assert len(steps) == 200
    assert reason is None


def test_keeping_the_best_outlives_too_large_a_rate():
    problem = Bowl([1.0, 1.0])

    steps, reason = run(
        GradientDescent(estimate_learning_rate="never", learning_rate=1.1), problem, [0.0, 0.0]
    )

    assert "fall -" in reason
    assert steps[-1].params.tolist() == [0.0, 0.0]


def test_says_when_nothing_overlaps_any_more():
    with pytest.raises(NoOverlapError):
        run(GradientDescent(maximum_step=30.0), Bowl([5.0, 0.0], fence=8.0), [0.0, 0.0])


def test_stops_at_a_slope_that_is_no_number():
    problem = Bowl([5.0, 5.0])
    problem.value_and_gradient = lambda _: (1.0, np.array([np.nan, 0.0]))

    steps, reason = run(GradientDescent(), problem, [0.0, 0.0])

    assert steps == []
    assert reason == "the slope is not a finite number"


def test_convergence_is_unknown_until_the_window_is_full():
    window = Window(4)

    assert [np.isinf(window.push(value)) for value in (3.0, 2.0, 1.0, 0.5)] == [True, True, True, False]


@pytest.mark.parametrize(
    ("values", "sign"), [([3.0, 2.0, 1.0], 1), ([1.0, 2.0, 3.0], -1), ([-1.0, -2.0, -3.0], 1)]
)
def test_convergence_is_positive_while_values_fall(values, sign):
    window = Window(3)

    assert np.sign([window.push(value) for value in values][-1]) == sign


@pytest.mark.parametrize("value", [0.0, 7.0])
def test_constant_values_have_converged(value):
    window = Window(5)

    assert abs([window.push(value) for _ in range(9)][-1]) < 1e-4


@pytest.mark.parametrize(
    ("options", "met"),
    [
        ({"learning_rate": 0.0}, "learning_rate.*0.0"),
        ({"convergence_window": 1}, "convergence_window.*1"),
        ({"convergence_minimum": float("inf")}, "convergence_minimum.*inf"),
        ({"keep": "first"}, "keep.*'best' or 'last'.*'first'"),
    ],
)
def test_refuses_bad_options_by_name_and_value(options, met):
    with pytest.raises(PresetError, match=met):
        OPTIMIZERS.build({"type": "gradient-descent", **options})
