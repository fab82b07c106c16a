"""The (1+1) evolution strategy: its slow twin, seeds, progress, stops and options."""

from itertools import islice

import numpy as np
import pytest

from naive.one_plus_one import walk
from naive.variates import Variates
from regframe.catalog import OPTIMIZERS
from regframe.errors import PresetError
from regframe.kernels.variates import Wallace
from regframe.optimizers.one_plus_one import OnePlusOne
from support.problems import Bowl, Rosenbrock, run


@pytest.mark.parametrize("scales", [[1.0, 1.0, 1.0, 1.0], [4e3, 9e3, 1.0, 1.0], [1.0, 1.0, 1e-3, 1e-3]])
def test_walks_the_path_of_its_slow_twin(scales):
    problem = Bowl([3.0, -2.0, 1.0, 5.0], stretch=[1.0, 4.0, 0.5, 2.0], scales=scales)
    twin = Variates(7)
    expected = walk(
        lambda p: float(problem.values(np.array([p]))[0]),
        [0.0] * 4,
        scales,
        twin.draw,
        radius=1.5,
        iterations=120,
    )

    steps, _ = run(OnePlusOne(radius=1.5), problem, np.zeros(4), iterations=120, seed=7)

    assert [step.params.tolist() for step in steps] == [parent for parent, _, _ in expected]
    assert [step.value for step in steps] == [best for _, best, _ in expected]
    assert [step.size for step in steps] == [size for _, _, size in expected]


def test_same_seed_same_path():
    first, _ = run(OnePlusOne(), Bowl([5.0, 5.0]), [0.0, 0.0], seed=3)
    again, _ = run(OnePlusOne(), Bowl([5.0, 5.0]), [0.0, 0.0], seed=3)

    assert [s.params.tolist() for s in first] == [s.params.tolist() for s in again]


def test_another_seed_another_path():
    first, _ = run(OnePlusOne(), Bowl([5.0, 5.0]), [0.0, 0.0], seed=3, iterations=5)
    other, _ = run(OnePlusOne(), Bowl([5.0, 5.0]), [0.0, 0.0], seed=4, iterations=5)

    assert first[-1].params.tolist() != other[-1].params.tolist()


@pytest.mark.parametrize("variates", ["wallace", "numpy"])
def test_ends_on_a_bowl(variates):
    steps, reason = run(
        OnePlusOne(variates=variates, epsilon=1e-3), Bowl([8.0, -6.0, 4.0]), [0.0] * 3, iterations=5000
    )

    assert "epsilon" in reason
    np.testing.assert_allclose(steps[-1].params, [8.0, -6.0, 4.0], atol=0.01)  # 10 epsilon


def test_follows_a_bent_valley():
    steps, _ = run(OnePlusOne(radius=0.3), Rosenbrock(), [-1.2, 1.0], iterations=3000)

    assert steps[-1].value < 1e-3  # 24.2 at the start


@pytest.mark.parametrize("start", [[0.0, 0.0], [5.0, 5.0]])
def test_is_never_worse_than_its_start(start):
    problem = Bowl([5.0, 5.0])
    before = problem.values(np.array([start]))[0]

    steps, _ = run(OnePlusOne(), problem, start, iterations=50)

    assert all(step.value <= before for step in steps)


def test_tells_the_value_at_its_position():
    problem = Bowl([5.0, 5.0])

    steps, _ = run(OnePlusOne(), problem, [0.0, 0.0], iterations=40)

    assert [s.value for s in steps] == [problem.values(s.params[None])[0] for s in steps]


def test_measures_one_child_an_iteration():
    problem = Bowl([5.0, 5.0])

    run(OnePlusOne(), problem, [0.0, 0.0], iterations=40)

    assert len(problem.visited) == 1 + 40


def test_consumes_one_deviate_a_parameter_an_iteration():
    rng, untouched = Wallace(9), Wallace(9)

    list(islice(OnePlusOne().steps(Bowl([5.0, 5.0, 1.0]), np.zeros(3), rng), 10))

    untouched.standard_normal(30)
    assert rng.standard_normal(1) == untouched.standard_normal(1)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_never_accepts_what_is_no_finite_number(bad):
    problem = Bowl([5.0, 5.0])
    plain = problem.values
    problem.values = lambda batch: np.where(batch[:, 0] > 0.5, bad, plain(batch))

    steps, _ = run(OnePlusOne(), problem, [0.0, 0.0], iterations=100)

    assert all(np.isfinite(step.value) and step.params[0] <= 0.5 for step in steps)


def test_finds_its_way_from_a_start_without_value():
    steps, _ = run(OnePlusOne(radius=4.0), Bowl([5.0, 5.0], fence=6.5), [0.0, 0.0], iterations=200)

    assert np.isfinite(steps[-1].value)


def test_reports_a_success_of_the_iteration_that_stops():
    problem = Bowl([5.0, 5.0])

    steps, reason = run(OnePlusOne(radius=0.5, epsilon=10.0), problem, [0.0, 0.0], seed=3)  # towards (1, 3)

    assert [s.params.tolist() for s in steps] == [problem.visited[1].tolist()]
    assert reason == "the search radius 0.707 has fallen to epsilon (10)"


def test_a_failure_in_the_iteration_that_stops_is_no_step():
    problem = Bowl([5.0, 5.0])

    steps, reason = run(OnePlusOne(radius=0.5, epsilon=10.0), problem, [0.0, 0.0], seed=2)  # away from (1, 1)

    assert steps == []
    assert "epsilon" in reason
    assert len(problem.visited) == 2


def test_leaves_its_start_alone():
    start = np.zeros(2)

    run(OnePlusOne(), Bowl([5.0, 5.0]), start, iterations=20)

    assert start.tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("options", "met"),
    [
        ({"radius": 0.0}, "radius.*0.0"),
        ({"radius": float("inf")}, "radius.*finite"),
        ({"growth": 1.0}, "growth.*1.0"),
        ({"shrink": 1.0}, "shrink.*1.0"),
        ({"epsilon": -1.0}, "epsilon.*-1.0"),
        ({"variates": "walace"}, "variates.*'wallace' or 'numpy'.*'walace'"),
        ({"radios": 1.0}, "radios: unknown option. Did you mean 'radius'"),
    ],
)
def test_refuses_bad_options_by_name_and_value(options, met):
    with pytest.raises(PresetError, match=met):
        OPTIMIZERS.build({"type": "one-plus-one", **options})


def test_survives_a_preset():
    optimizer = OnePlusOne(radius=2.0, shrink=0.9)

    assert OPTIMIZERS.build(OPTIMIZERS.dump(optimizer)) == optimizer
