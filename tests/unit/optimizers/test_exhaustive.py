"""The exhaustive scan: its lattice, what it tells, and its options."""

import numpy as np
import pytest

from regframe.catalog import OPTIMIZERS
from regframe.errors import PresetError
from regframe.optimizers.exhaustive import Exhaustive
from support.problems import Bowl, run


def test_visits_a_lattice_the_first_parameter_fastest():
    problem = Bowl([10.0, 10.0])

    run(Exhaustive(number_of_steps=(1, 1), step_length=2.0), problem, [5.0, 5.0])

    assert [at.tolist() for at in problem.visited] == [
        [5.0, 5.0],
        *([x, y] for y in (3.0, 5.0, 7.0) for x in (3.0, 5.0, 7.0)),
    ]


def test_scales_multiply_the_step():
    problem = Bowl([10.0, 10.0], scales=[2.0, 0.1])

    run(Exhaustive(number_of_steps=(1, 1)), problem, [0.0, 0.0])

    assert problem.visited[1].tolist() == [-2.0, -0.1]


@pytest.mark.parametrize(("tell", "more"), [("best", 0), ("each", 1)])
def test_ends_at_the_lowest_position(tell, more):
    optimizer = Exhaustive(number_of_steps=(3, 3), tell=tell)

    steps, reason = run(optimizer, Bowl([2.2, -0.9]), [0.0, 0.0])

    assert len(steps) == 49 + more
    assert steps[-1].params.tolist() == [2.0, -1.0]
    assert reason == "all 49 positions are measured"


def test_tells_each_position_when_told():
    problem = Bowl([2.2, -0.9])

    steps, _ = run(Exhaustive(tell="each"), problem, [0.0, 0.0])

    assert [s.params.tolist() for s in steps[:-1]] == [at.tolist() for at in problem.visited[1:]]
    assert [s.value for s in steps] == problem.values(np.array([s.params for s in steps])).tolist()


def test_a_cut_scan_ends_at_the_best_so_far():
    steps, _ = run(Exhaustive(number_of_steps=(3, 3)), Bowl([0.0, -3.0]), [0.0, 0.0], iterations=10)

    assert steps[-1].params.tolist() == [0.0, -3.0]


def test_one_number_stands_for_all_parameters():
    steps, _ = run(Exhaustive(number_of_steps=(1,)), Bowl([1.0] * 3), [0.0] * 3)

    assert len(steps) == 27


def test_zero_leaves_a_parameter_alone():
    problem = Bowl([1.0, 1.0])

    run(Exhaustive(number_of_steps=(0, 2)), problem, [0.5, 0.0])

    assert {at[0] for at in problem.visited} == {0.5}


def test_refuses_another_number_of_parameters():
    with pytest.raises(PresetError, match=r"number_of_steps` has 2 numbers.*3 parameters"):
        run(Exhaustive(number_of_steps=(1, 1)), Bowl([1.0] * 3), [0.0] * 3)


@pytest.mark.parametrize(
    ("options", "met"),
    [
        ({"number_of_steps": [-1]}, "number_of_steps.*-1"),
        ({"number_of_steps": []}, "number_of_steps"),
        ({"step_length": 0.0}, "step_length.*0.0"),
        ({"tell": "all"}, "tell.*'best' or 'each'.*'all'"),
    ],
)
def test_refuses_bad_options_by_name_and_value(options, met):
    with pytest.raises(PresetError, match=met):
        OPTIMIZERS.build({"type": "exhaustive", **options})


def test_survives_a_preset():
    optimizer = Exhaustive(number_of_steps=(1, 2, 0))

    assert OPTIMIZERS.build(OPTIMIZERS.dump(optimizer)) == optimizer
