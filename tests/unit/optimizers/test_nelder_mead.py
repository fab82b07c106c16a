import numpy as np
import pytest

from regframe.optimizers.amoeba import Amoeba
from regframe.optimizers.nelder_mead import NelderMead
from regframe.testing.optimizer_checks import Bowl, walk


class Counted(Bowl):
    """A bowl that remembers where it was measured."""

    def __init__(self, dim):
        super().__init__(dim)
        self.met = []

    def values(self, batch):
        self.met += list(batch.copy())
        return super().values(batch)


@pytest.mark.parametrize("bound", [0.5, 3.0])
def test_no_corner_is_measured_beyond_the_bound(bound):
    problem, start = Counted(6), np.full(6, 5.0)

    steps, _ = walk(NelderMead(bound=bound), problem, start)

    assert np.abs(np.array(problem.met) - start).max() <= bound + 1e-12
    np.testing.assert_allclose(steps[-1].params, start - bound, atol=0.1)


def test_a_bound_is_in_the_unit_of_scales():
    problem, start = Counted(4), np.full(4, 5.0)
    problem.scales = np.full(4, 10.0)

    walk(NelderMead(bound=3.0), problem, start, iterations=100)

    assert np.abs(np.array(problem.met) - start).max() <= 0.3 + 1e-12


def test_eight_parameters_need_fewer_evaluations_than_the_amoeba():
    start = np.tile([3.0, -2.0], 4)
    used = {}
    for optimizer in (NelderMead(), Amoeba()):
        problem = Counted(8)
        walker = optimizer.steps(problem, start, optimizer.normals(1))
        for step in walker:
            if step.value < 0.05:
                break
        used[type(optimizer)] = len(problem.met)

    assert used[NelderMead] < used[Amoeba]


def test_restarts_are_counted():
    never, twice = (walk(NelderMead(restarts=n), Bowl(), np.full(4, 2.0))[0] for n in (0, 2))

    assert len(never) < len(twice)
    assert twice[-1].value <= never[-1].value
