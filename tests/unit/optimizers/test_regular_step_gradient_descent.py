"""Regular step descent: its path, progress, what it keeps, stops and options."""

import numpy as np
import pytest

from regframe.catalog import OPTIMIZERS
from regframe.errors import NoOverlapError, PresetError
from regframe.optimizers.regular_step_gradient_descent import RegularStepGradientDescent
from support.problems import Bowl, Rosenbrock, run

KEEPS = ["best", "last"]


def test_walks_steps_of_the_set_length():
    steps, _ = run(RegularStepGradientDescent(keep="last"), Bowl([10.0, 0.0]), [0.0, 0.0], iterations=5)

    assert [s.params.tolist() for s in steps] == [[1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, 0.0], [5.0, 0.0]]
    assert [s.value for s in steps] == [100.0, 81.0, 64.0, 49.0, 36.0]  # where each step began
    assert [s.size for s in steps] == [1.0] * 5


def test_shortens_its_step_when_the_slope_turns_back():
    steps, _ = run(RegularStepGradientDescent(keep="last"), Bowl([1.25]), [0.0], iterations=5)

    assert [s.params.item() for s in steps] == [1.0, 2.0, 1.5, 1.0, 1.25]
    assert [s.size for s in steps] == [1.0, 1.0, 0.5, 0.5, 0.25]


def test_scales_turn_the_direction():
    optimizer = RegularStepGradientDescent(keep="last")

    steps, _ = run(optimizer, Bowl([10.0, 10.0], scales=[3.0, 4.0]), [0.0, 0.0], iterations=1)

    np.testing.assert_allclose(steps[0].params, [0.8, 0.6], rtol=1e-15)


def test_takes_scales_of_nearly_one_for_ones():
    optimizer = RegularStepGradientDescent(keep="last")

    steps, _ = run(optimizer, Bowl([10.0, 10.0], scales=[1.009, 0.991]), [0.0, 0.0], iterations=1)

    np.testing.assert_allclose(steps[0].params, np.sqrt([0.5, 0.5]), rtol=1e-15)


@pytest.mark.parametrize("keep", KEEPS)
def test_ends_on_a_bowl(keep):
    steps, reason = run(
        RegularStepGradientDescent(keep=keep), Bowl([8.0, -6.3], stretch=[1.0, 3.0]), [0.0, 0.0]
    )

    assert "minimum_step" in reason
    np.testing.assert_allclose(steps[-1].params, [8.0, -6.3], atol=0.01)  # ten times the last step


def test_follows_a_bent_valley():
    optimizer = RegularStepGradientDescent(learning_rate=0.2, relaxation=0.9, minimum_step=1e-5)

    steps, _ = run(optimizer, Rosenbrock(), [-1.2, 1.0], iterations=3000)

    assert steps[-1].value < 1.0  # 24.2 at the start, 4.1 on the valley's floor beside it


@pytest.mark.parametrize("iterations", [1, 2, 30])
@pytest.mark.parametrize("start", [[0.0, 0.0], [5.0, 5.0], [5.0, 5.0001]])
def test_keeping_the_best_is_never_worse_than_the_start(start, iterations):
    problem = Bowl([5.0, 5.0])
    before = problem.values(np.array([start]))[0]

    steps, _ = run(RegularStepGradientDescent(gradient_tolerance=0.0), problem, start, iterations=iterations)

    assert all(problem.values(step.params[None])[0] <= before for step in steps)


def test_keeping_the_best_tells_the_value_at_its_position():
    problem = Bowl([3.3, 1.7])

    steps, _ = run(RegularStepGradientDescent(), problem, [0.0, 0.0])

    assert [s.value for s in steps] == [problem.values(s.params[None])[0] for s in steps]


def test_keeping_the_best_does_not_change_the_path():
    best, last = Bowl([3.3, 1.7]), Bowl([3.3, 1.7])

    run(RegularStepGradientDescent(keep="best"), best, [0.0, 0.0])
    run(RegularStepGradientDescent(keep="last"), last, [0.0, 0.0])

    assert [at.tolist() for at in best.visited] == [at.tolist() for at in last.visited]


@pytest.mark.parametrize(("keep", "price"), [("best", 1), ("last", 0)])
def test_keeping_the_best_costs_one_more_evaluation(keep, price):
    problem = Bowl([50.0, 0.0])

    run(RegularStepGradientDescent(keep=keep), problem, [0.0, 0.0], iterations=10)

    assert len(problem.visited) == 10 + price


def test_does_not_draw_deviates():
    problem, optimizer = Bowl([3.3, 1.7]), RegularStepGradientDescent()

    first, _ = run(optimizer, problem, [0.0, 0.0], seed=1)
    other, _ = run(optimizer, problem, [0.0, 0.0], seed=2)

    assert [s.params.tolist() for s in first] == [s.params.tolist() for s in other]


def test_stops_where_it_is_flat():
    steps, reason = run(RegularStepGradientDescent(), Bowl([5.0, 5.0]), [5.0, 5.0])

    assert steps == []
    assert reason == "the slope 0 has fallen below gradient_tolerance (0.0001)"


def test_stops_at_a_slope_that_is_no_number():
    problem = Bowl([5.0, 5.0])
    problem.value_and_gradient = lambda _: (1.0, np.array([np.nan, 0.0]))

    steps, reason = run(RegularStepGradientDescent(), problem, [0.0, 0.0])

    assert steps == []
    assert reason == "the slope is not a finite number"


@pytest.mark.parametrize("keep", KEEPS)
def test_says_when_nothing_overlaps_any_more(keep):
    optimizer = RegularStepGradientDescent(learning_rate=30.0, keep=keep)

    with pytest.raises(NoOverlapError):
        run(optimizer, Bowl([5.0, 0.0], fence=8.0), [0.0, 0.0])


@pytest.mark.parametrize(
    ("when", "sizes"), [("never", [1.0] * 3), ("once", [2.0] * 3), ("each-iteration", [2.0, 1.0, 2.0])]
)
def test_estimates_its_learning_rate_when_told(when, sizes):
    problem = Bowl([100.0, 0.0])
    asked = []
    # Motion per unit step: 1 at the first estimate, 2 at the second, 1 at the third.
    problem.motion = lambda at, step: (
        float(np.hypot(*step)) * (1 + len(asked) % 2) + (asked.append(at) or 0.0)
    )
    optimizer = RegularStepGradientDescent(estimate_learning_rate=when, maximum_step=2.0, keep="last")

    steps, _ = run(optimizer, problem, [0.0, 0.0], iterations=3)

    assert [s.size for s in steps] == pytest.approx(sizes, rel=1e-15)


def test_leaves_its_start_alone():
    start = np.zeros(2)

    run(RegularStepGradientDescent(), Bowl([5.0, 5.0]), start, iterations=20)

    assert start.tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("options", "met"),
    [
        ({"learning_rate": 0.0}, "learning_rate.*0.0"),
        ({"minimum_step": -1.0}, "minimum_step.*-1.0"),
        ({"minimum_step": 2.0}, r"`minimum_step` must not exceed `learning_rate` \(1\).*2.0"),
        ({"relaxation": 1.0}, "relaxation.*1.0"),
        ({"gradient_tolerance": -1e-3}, "gradient_tolerance.*-0.001"),
        (
            {"estimate_learning_rate": "always"},
            "estimate_learning_rate.*'never', 'once' or 'each-iteration'.*'always'",
        ),
        ({"maximum_step": 0.0}, "maximum_step.*0.0"),
        ({"keep": "first"}, "keep.*'best' or 'last'.*'first'"),
        ({"learning_rates": 1.0}, "learning_rates: unknown option. Did you mean 'learning_rate'"),
    ],
)
def test_refuses_bad_options_by_name_and_value(options, met):
    with pytest.raises(PresetError, match=met):
        OPTIMIZERS.build({"type": "regular-step-gradient-descent", **options})


def test_survives_a_preset():
    optimizer = RegularStepGradientDescent(learning_rate=2.0, keep="last")

    assert OPTIMIZERS.build(OPTIMIZERS.dump(optimizer)) == optimizer
