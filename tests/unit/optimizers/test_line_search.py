"""Descents with a line search: the search, their directions, what they keep, and options."""

import numpy as np
import pytest

from regframe.catalog import OPTIMIZERS
from regframe.errors import PresetError
from regframe.optimizers.conjugate_gradient_line_search import ConjugateGradientLineSearch
from regframe.optimizers.gradient_descent_line_search import GradientDescentLineSearch
from regframe.optimizers.line_search import golden
from support.problems import Bowl, run

KINDS = [GradientDescentLineSearch, ConjugateGradientLineSearch]


@pytest.mark.parametrize("lowest", [0.02, 0.7, 1.0, 3.0, 4.9])
def test_finds_the_lowest_place_of_a_bracket(lowest):
    found = golden(lambda x: (x - lowest) ** 2, (0.0, 1.0, 5.0), 1e-4, 100)

    assert found == pytest.approx(lowest, abs=1e-3)


def test_turns_back_from_where_nothing_overlaps():
    found = golden(lambda x: (x - 0.7) ** 2 if x < 0.8 else np.inf, (0.0, 2.0, 5.0), 1e-4, 100)

    assert found == pytest.approx(0.7, abs=1e-3)


def test_ends_after_so_many_rounds():
    asked = []

    golden(lambda x: asked.append(x) or (x - 2.0) ** 2, (0.0, 1.0, 5.0), 1e-12, 4)

    assert len(asked) == 6  # five rounds, as ITK counts, and the middle of the bracket


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("keep", ["best", "itk"])
def test_ends_on_a_bowl(kind, keep):
    steps, reason = run(kind(keep=keep), Bowl([8.0, -6.3], stretch=[1.0, 3.0]), [0.0, 0.0])

    assert "convergence_minimum" in reason
    np.testing.assert_allclose(steps[-1].params, [8.0, -6.3], atol=0.01)


def test_conjugate_directions_need_fewer_iterations_in_a_long_bowl():
    ends = [
        run(kind(), Bowl([9.0] * 3, stretch=[1, 5, 30]), [0.0] * 3, iterations=6)[0][-1] for kind in KINDS
    ]

    assert ends[1].value < 1e-3 * ends[0].value


def test_conjugate_directions_are_forgotten_when_they_mislead():
    turn = ConjugateGradientLineSearch().direction()

    turn(np.array([1.0, 0.0]))

    assert turn(np.array([10.0, 0.0])).tolist() == [10.0, 0.0]  # a share of 90
    assert turn(np.array([5.0, 0.0])).tolist() == [5.0, 0.0]  # a share below 0
    np.testing.assert_allclose(turn(np.array([0.0, 5.0])), [5.0, 5.0])  # a share of 1


def test_two_levels_do_not_share_directions():
    optimizer = ConjugateGradientLineSearch()

    optimizer.direction()(np.array([0.0, 1.0]))

    assert optimizer.direction()(np.array([1.0, 0.0])).tolist() == [1.0, 0.0]


@pytest.mark.parametrize("kind", KINDS)
def test_keeping_the_best_tells_the_value_at_its_position(kind):
    problem = Bowl([3.3, 1.7], stretch=[1.0, 4.0])

    steps, _ = run(kind(), problem, [0.0, 0.0])

    assert [s.value for s in steps] == [problem.values(s.params[None])[0] for s in steps]


@pytest.mark.parametrize("kind", KINDS)
def test_estimates_its_first_learning_rate_when_told(kind):
    asked = Bowl([1e4, 0.0]), Bowl([1e4, 0.0])
    for problem, when in zip(asked, ["never", "once"], strict=True):
        run(
            kind(estimate_learning_rate=when, learning_rate=1e-3, maximum_step=3.0),
            problem,
            [0.0, 0.0],
            iterations=1,
        )

    # The search's second value is that at the learning rate itself.
    assert [problem.visited[2][0] for problem in asked] == pytest.approx([20.0, 3.0])


def test_stops_at_a_slope_that_is_no_number():
    problem = Bowl([5.0, 5.0])
    problem.value_and_gradient = lambda _: (1.0, np.array([np.nan, 0.0]))

    steps, reason = run(GradientDescentLineSearch(), problem, [0.0, 0.0])

    assert steps == []
    assert reason == "the slope is not a finite number"


@pytest.mark.parametrize(
    ("options", "met"),
    [
        ({"lower_limit": 1.0}, "lower_limit.*1"),
        ({"upper_limit": 1.0}, "upper_limit.*1"),
        ({"line_tolerance": 0.0}, "line_tolerance.*0"),
        ({"estimate_learning_rate": "each-iteration"}, "'never' or 'once'.*'each-iteration'"),
        ({"keep": "last"}, "keep.*'best' or 'itk'.*'last'"),
    ],
)
def test_refuses_bad_options_by_name_and_value(options, met):
    with pytest.raises(PresetError, match=met):
        OPTIMIZERS.build({"type": "gradient-descent-line-search", **options})
