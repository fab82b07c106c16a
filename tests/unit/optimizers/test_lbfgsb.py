"""L-BFGS-B: its path, bounds, missing overlap, threads and options."""

from threading import active_count

import numpy as np
import pytest
from scipy.optimize import minimize

from regframe.catalog import OPTIMIZERS
from regframe.errors import NoOverlapError, PresetError
from regframe.optimizers.handover import turns
from regframe.optimizers.lbfgsb import Lbfgsb
from support.problems import Bowl, Rosenbrock, run


def test_walks_scipys_path():
    seen = []
    problem = Rosenbrock()
    minimize(
        problem.value_and_gradient,
        [-1.2, 1.0],
        jac=True,
        method="L-BFGS-B",
        options={"maxcor": 5},
        callback=lambda x: seen.append(x.copy()),
    )

    steps, reason = run(Lbfgsb(), Rosenbrock(), [-1.2, 1.0])

    assert "convergence" in reason
    np.testing.assert_array_equal([step.params for step in steps][: len(seen) - 2], seen[:-2])
    np.testing.assert_allclose(steps[-1].params, [1.0, 1.0], atol=1e-3)


def test_stays_within_its_bounds():
    problem = Bowl([5.0, -5.0])

    steps, _ = run(Lbfgsb(lower=-2.0, upper=3.0), problem, [0.0, 0.0])

    assert steps[-1].params.tolist() == [3.0, -2.0]
    assert np.abs(problem.visited).max() <= 3.0


def test_comes_back_from_where_nothing_overlaps():
    # The first probe, one pixel off, is already beyond.
    problem = Bowl([0.3, 0.0], fence=0.4)

    steps, _ = run(Lbfgsb(), problem, [0.0, 0.0])

    assert any(np.isinf(problem.values(at[None])[0]) for at in problem.visited)
    np.testing.assert_allclose(steps[-1].params, [0.3, 0.0], atol=1e-4)


def test_a_start_without_overlap_is_an_error():
    with pytest.raises(NoOverlapError):
        run(Lbfgsb(), Bowl([5.0, 0.0], fence=1.0), [0.0, 0.0])


def test_says_when_the_slope_does_not_fit():
    problem = Bowl([5.0, 0.0])
    honest = problem.value_and_gradient
    problem.value_and_gradient = lambda at: (honest(at)[0], -honest(at)[1])

    steps, reason = run(Lbfgsb(), problem, [0.0, 0.0])

    assert steps == []
    assert "no lower place" in reason


@pytest.mark.parametrize("taken", [0, 1, 3])
def test_leaves_no_thread_behind(taken):
    before = active_count()
    walk = Lbfgsb().steps(Rosenbrock(), np.array([-1.2, 1.0]), None)

    for _ in range(taken):
        next(walk)
    walk.close()

    assert active_count() == before


def test_a_fault_of_the_search_is_raised_here():
    def search(*_):
        message = "lost"
        raise ArithmeticError(message)

    with pytest.raises(ArithmeticError, match="lost"):
        list(turns(search, lambda at: (0.0, at)))


def test_a_fault_of_the_cost_ends_the_search():
    def cost(_):
        message = "no slope"
        raise ArithmeticError(message)

    before = active_count()
    with pytest.raises(ArithmeticError, match="no slope"):
        list(turns(lambda ask, _: str(ask(np.zeros(2))), cost))

    assert active_count() == before


@pytest.mark.parametrize(
    ("options", "met"),
    [
        ({"lower": 2.0, "upper": 1.0}, r"`lower` must be below `upper` \(1\)"),
        ({"corrections": 0}, "corrections.*0"),
        ({"gradient_tolerance": -1.0}, "gradient_tolerance.*-1"),
    ],
)
def test_refuses_bad_options_by_name_and_value(options, met):
    with pytest.raises(PresetError, match=met):
        OPTIMIZERS.build({"type": "lbfgsb", **options})
