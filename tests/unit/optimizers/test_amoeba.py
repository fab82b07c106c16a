"""Amoeba: its simplex, progress, stop and options."""

import numpy as np
import pytest

from regframe.catalog import OPTIMIZERS
from regframe.errors import PresetError
from regframe.optimizers.amoeba import Amoeba
from support.problems import Bowl, Rosenbrock, run


def test_begins_with_a_corner_a_parameter():
    problem = Bowl([10.0, 10.0])

    run(Amoeba(simplex_delta=3.0), problem, [1.0, 1.0], iterations=1)

    assert [at.tolist() for at in problem.visited[:3]] == [[1.0, 1.0], [4.0, 1.0], [1.0, 4.0]]


def test_the_first_simplex_is_as_long_after_scaling():
    problem = Bowl([10.0, 10.0], scales=[10.0, 0.5])

    run(Amoeba(simplex_delta=3.0), problem, [1.0, 1.0], iterations=1)

    np.testing.assert_allclose(problem.visited[1:3], [[1.3, 1.0], [1.0, 7.0]])


def test_ends_on_a_bowl():
    steps, reason = run(Amoeba(), Bowl([8.0, -6.3], stretch=[1.0, 3.0]), [0.0, 0.0])

    assert "parameters_tolerance" in reason
    np.testing.assert_allclose(steps[-1].params, [8.0, -6.3], atol=0.02)


def test_follows_a_bent_valley():
    steps, _ = run(Amoeba(parameters_tolerance=1e-6, value_tolerance=1e-8), Rosenbrock(), [-1.2, 1.0])

    np.testing.assert_allclose(steps[-1].params, [1.0, 1.0], atol=1e-3)


def test_values_never_rise():
    steps, _ = run(Amoeba(), Rosenbrock(), [-1.2, 1.0])

    values = [step.value for step in steps]
    assert values == sorted(values, reverse=True)


@pytest.mark.parametrize("option", ["simplex_delta", "parameters_tolerance", "value_tolerance"])
def test_refuses_bad_options_by_name_and_value(option):
    with pytest.raises(PresetError, match=f"{option}.*-1"):
        OPTIMIZERS.build({"type": "amoeba", option: -1.0})
