"""Powell: its rounds, what it keeps, its line search, stops and options."""

import numpy as np
import pytest

from regframe.catalog import OPTIMIZERS
from regframe.errors import PresetError
from regframe.optimizers.brent import bracket, lowest
from regframe.optimizers.powell import Powell
from support.problems import Bowl, Rosenbrock, run


@pytest.mark.parametrize("keep", ["best", "last"])
def test_ends_on_a_bowl(keep):
    steps, reason = run(Powell(keep=keep), Bowl([8.0, -6.3], stretch=[1.0, 3.0]), [0.0, 0.0])

    assert "value_tolerance" in reason
    np.testing.assert_allclose(steps[-1].params, [8.0, -6.3], atol=1e-3)


def test_follows_a_bent_valley():
    steps, _ = run(Powell(step_tolerance=1e-6), Rosenbrock(), [-1.2, 1.0])

    np.testing.assert_allclose(steps[-1].params, [1.0, 1.0], atol=1e-3)


def test_keeping_the_last_may_end_beyond_the_best():
    best, _ = run(Powell(), Bowl([8.0, -6.3]), [0.0, 0.0], iterations=1)
    last, _ = run(Powell(keep="last"), Bowl([8.0, -6.3]), [0.0, 0.0], iterations=1)

    np.testing.assert_allclose(best[0].params, [8.0, -6.3], atol=1e-3)
    np.testing.assert_allclose(last[0].params, [16.0, -12.6], atol=1e-2)
    assert best[0].value == last[0].value


def test_scales_shorten_the_first_step():
    problem = Bowl([100.0, 100.0], scales=[4.0, 1.0])

    run(Powell(step_length=2.0), problem, [0.0, 0.0], iterations=1)

    assert problem.visited[1].tolist() == [0.5, 0.0]


def test_a_round_that_moves_and_stops_is_told():
    steps, reason = run(Powell(value_tolerance=1e9), Bowl([5.0, 5.0]), [0.0, 0.0])

    assert len(steps) == 1
    assert "value_tolerance" in reason
    np.testing.assert_allclose(steps[0].params, [5.0, 5.0], atol=1e-3)


def test_brackets_the_lowest_place():
    ends, middle = bracket(lambda x: (x - 10.0) ** 2, 100.0, 1.0)

    assert ends[0] < middle.at < ends[1]
    assert ends[0] <= 10.0 <= ends[1]


def test_searches_behind_the_start_too():
    found = lowest(lambda x: (x + 3.0) ** 2, 9.0, 1.0, 1e-6, 100)

    assert found.at == pytest.approx(-3.0, abs=1e-5)


def test_passes_by_places_without_overlap():
    found = lowest(lambda x: (x - 3.0) ** 2 if x < 3.5 else np.inf, 9.0, 1.0, 1e-6, 100)

    assert found.at == pytest.approx(3.0, abs=1e-5)


def test_searches_no_longer_than_told():
    asked = []

    lowest(lambda x: asked.append(x) or (x - 0.3) ** 2, 0.09, 1.0, 1e-12, 3)

    assert len(asked) == 5  # two for the bracket


@pytest.mark.parametrize(
    ("options", "met"),
    [
        ({"step_length": 0.0}, "step_length.*0.0"),
        ({"step_tolerance": 0.0}, "step_tolerance.*0.0"),
        ({"line_iterations": 0}, "line_iterations.*0"),
        ({"keep": "first"}, "keep.*'best' or 'last'.*'first'"),
    ],
)
def test_refuses_bad_options_by_name_and_value(options, met):
    with pytest.raises(PresetError, match=met):
        OPTIMIZERS.build({"type": "powell", **options})
