import numpy as np

from regframe.optimizers.lbfgsb import Lbfgsb
from regframe.optimizers.multi_start import MultiStart
from regframe.optimizers.nelder_mead import NelderMead
from regframe.testing.optimizer_checks import Bowl, walk


class TwoValleys(Bowl):
    """A shallow valley at the origin, where walks begin, and a deep one at (6, 6)."""

    def __init__(self):
        super().__init__(2)

    def values(self, batch):
        near, far = (batch**2).sum(axis=1), ((batch - 6.0) ** 2).sum(axis=1)
        return -np.exp(-near / 4) - 3 * np.exp(-far / 4)


def test_finds_the_deeper_valley_that_one_walk_misses():
    alone, _ = walk(NelderMead(), TwoValleys(), np.zeros(2))
    many, reason = walk(MultiStart(optimizer=NelderMead()), TwoValleys(), np.zeros(2))

    assert alone[-1].value > -1.5
    np.testing.assert_allclose(many[-1].params, [6.0, 6.0], atol=0.1)
    assert "3 places" in reason


def test_no_place_is_farther_than_the_radius():
    met = []

    class Watched(Bowl):
        def values(self, batch):
            met.extend(batch.copy())
            return super().values(batch)

    walker = MultiStart(starts=40, radius=2.5).steps(Watched(), np.full(4, 7.0), np.random.default_rng(1))
    next(walker)
    walker.close()

    assert np.abs(np.array(met[:41]) - 7.0).max() <= 2.5


def test_a_walk_that_leaves_the_overlap_ends_and_others_go_on():
    problem = Bowl(fence=11.0)

    steps, reason = walk(MultiStart(optimizer=Lbfgsb()), problem, np.array([8.0, -5.0, 3.0, 3.0]))

    assert steps[-1].value < 1e-6
    assert reason.startswith("all")


def test_patience_limits_each_walk():
    optimizer = MultiStart(optimizer=NelderMead(), walks=3, patience=4)

    steps, _ = walk(optimizer, Bowl(), np.full(4, 5.0))

    assert len(steps) == 12
