"""BFGS: few evaluations on a bowl, bounded steps, missing overlap, reasons to stop."""

import numpy as np

from regframe.optimizers.bfgs import Bfgs
from support.problems import Bowl, Rosenbrock, run


def test_needs_few_evaluations_on_a_bowl():
    problem = Bowl([3.0, -2.0, 1.0, 0.5], stretch=[0.02, 0.01, 0.03, 0.015])

    steps, reason = run(Bfgs(), problem, np.zeros(4))

    assert "shorter" in reason
    np.testing.assert_allclose(steps[-1].params, problem.target, atol=0.05)
    assert len(problem.visited) <= 15


def test_finds_the_end_of_a_bent_valley():
    steps, _ = run(Bfgs(tolerance=1e-6), Rosenbrock(), [-1.2, 1.0])

    np.testing.assert_allclose(steps[-1].params, [1.0, 1.0], atol=1e-3)


def test_no_step_is_longer_than_allowed():
    steps, _ = run(Bfgs(first_step=0.5, longest_step=2.0), Bowl([60.0, 0.0], stretch=0.01), [0.0, 0.0])

    places = np.array([[0.0, 0.0], *(step.params for step in steps)])
    lengths = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert lengths.max() <= 2.0 + 1e-12
    assert lengths[0] <= 0.5 + 1e-12
    np.testing.assert_allclose([step.size for step in steps], lengths)


def test_values_fall_at_every_step():
    steps, _ = run(Bfgs(tolerance=1e-6), Rosenbrock(), [-1.2, 1.0])

    assert (np.diff([step.value for step in steps]) < 0).all()


def test_comes_back_from_where_nothing_overlaps():
    problem = Bowl([0.3, 0.0], fence=0.4)

    steps, _ = run(Bfgs(first_step=1.0), problem, [0.0, 0.0])

    np.testing.assert_allclose(steps[-1].params, problem.target, atol=0.02)


def test_a_flat_place_is_told():
    steps, reason = run(Bfgs(), Bowl([0.0, 0.0]), [0.0, 0.0])

    assert steps == []
    assert reason == "the slope is 0"
