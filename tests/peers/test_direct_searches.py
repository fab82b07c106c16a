"""Powell, Amoeba and Exhaustive against SimpleITK's: the same bits on SimpleITK's own values."""

import numpy as np
import pytest

from regframe.optimizers.amoeba import Amoeba
from regframe.optimizers.exhaustive import Exhaustive
from regframe.optimizers.powell import Powell
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.problems import run
from support.runs import tell_optimizer
from support.sitk_problems import SitkProblem, path

TURNED = [1.04, -0.03, 6.0, -5.0]
CASES = [
    (Translation(), [3.0, -2.0], [1.0, 1.0], 1.0),
    (Translation(), [3.0, -2.0], [2.0, 0.5], 1.0),
    (Similarity(), TURNED, [1.0, 1.0, 1.005, 0.995], 0.05),
    (Similarity(), TURNED, [1400.0, 1500.0, 1.0, 1.0], 1.0),
]

pytestmark = pytest.mark.usefixtures("one_thread")


def cost(transform, start, scales):
    fixed, moving = peer.pair((32, 40))
    warp = Warp(transform, np.array(start), peer.frame(fixed))
    return SitkProblem(peer.method(fixed, moving, "linear"), fixed, moving, warp, scales)


def told_path(optimizer, problem, start, iterations):
    theirs = peer.method(*problem.pair, "linear")
    tell_optimizer(theirs, optimizer, iterations, 0.0)
    theirs.SetOptimizerScales(problem.scales.tolist())
    told, final = path(theirs, problem, start)
    return [np.array(t[0]) for t in told], [t[1] for t in told], final, theirs


@pytest.mark.parametrize("rounds", [1, 2, 4])
@pytest.mark.parametrize(("transform", "start", "scales", "step"), CASES)
def test_powell_walks_the_same_path(transform, start, scales, step, rounds):
    problem, optimizer = cost(transform, start, scales), Powell(step_length=step, keep="last")
    places, values, final, _ = told_path(optimizer, problem, start, rounds)

    steps, _ = run(optimizer, problem, start, iterations=rounds)

    assert len(steps) - len(places) in (0, 1)  # SimpleITK does not tell of the round that stops
    np.testing.assert_array_equal([s.params for s in steps[: len(places)]], places)
    np.testing.assert_array_equal([s.value for s in steps[: len(places)]], values)
    np.testing.assert_array_equal(steps[-1].params, final)


def test_powell_that_keeps_the_best_ends_where_simpleitk_has_been():
    transform, start, scales, step = CASES[3]
    problem = cost(transform, start, scales)
    _, values, final, _ = told_path(Powell(step_length=step), problem, start, 1)

    steps, _ = run(Powell(step_length=step), problem, start, iterations=1)

    assert steps[0].value == values[0] == problem.values(steps[0].params[None])[0]
    assert problem.values(final[None])[0] > values[0]  # SimpleITK ends at its extrapolated probe


@pytest.mark.parametrize("evaluations", [20, 60])
@pytest.mark.parametrize(("transform", "start", "scales", "delta"), CASES)
def test_amoeba_walks_the_same_path(transform, start, scales, delta, evaluations):
    optimizer = Amoeba(simplex_delta=delta, parameters_tolerance=1e-8)
    problem = cost(transform, start, scales)
    places, _, final, _ = told_path(optimizer, problem, start, evaluations)
    problem.visited.clear()

    # SimpleITK's limit is one of evaluations, the first simplex not counted.
    walk, step = optimizer.steps(problem, np.array(start), None), None
    while len(problem.visited) - (len(start) + 1) < evaluations:
        step = next(walk)

    # Its last event comes from measuring the best corner once more.
    np.testing.assert_array_equal(problem.visited, places[: len(problem.visited)])
    np.testing.assert_array_equal(step.params, final)


@pytest.mark.parametrize(("transform", "start", "scales", "delta"), CASES)
def test_amoeba_stops_where_simpleitk_does(transform, start, scales, delta):
    optimizer = Amoeba(simplex_delta=delta, parameters_tolerance=1e-2, value_tolerance=1e-3)
    problem = cost(transform, start, scales)
    _, _, final, theirs = told_path(optimizer, problem, start, 1000)

    steps, reason = run(optimizer, problem, start)

    assert "tolerance" in reason
    assert "tolerance" in theirs.GetOptimizerStopConditionDescription()
    np.testing.assert_array_equal(steps[-1].params, final)


@pytest.mark.parametrize(
    ("transform", "start", "scales", "counts"),
    [
        (Translation(), [3.0, -2.0], [2.0, 0.5], (2, 3)),
        (Similarity(), TURNED, [0.02, 0.03, 1.0, 1.0], (1, 2, 1, 0)),
    ],
)
def test_exhaustive_visits_the_same_positions(transform, start, scales, counts):
    problem = cost(transform, start, scales)
    each = Exhaustive(number_of_steps=counts, step_length=0.7, tell="each")
    places, values, final, theirs = told_path(each, problem, start, 0)

    steps, _ = run(each, problem, start)

    np.testing.assert_array_equal([s.params for s in steps[:-1]], places)
    np.testing.assert_array_equal([s.value for s in steps[:-1]], values)
    np.testing.assert_array_equal(steps[-1].params, final)
    assert steps[-1].value == theirs.GetMetricValue()
