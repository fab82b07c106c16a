"""The (1+1) evolution strategy against SimpleITK's, iteration by iteration, on the same cost."""

import numpy as np
import pytest

from regframe.optimizers.one_plus_one import OnePlusOne
from regframe.transforms.similarity import Similarity
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.problems import run
from support.sitk_problems import SitkProblem, path

START = [1.04, -0.03, 6.0, -5.0]  # the images are aligned at the identity
SCALES = [([1.0, 1.0, 1.0, 1.0], 0.05), ([1.0, 1.0, 1e-3, 1e-3], 4e-3), ([1400.0, 1500.0, 1.0, 1.0], 2.0)]

pytestmark = pytest.mark.usefixtures("one_thread")


def problem(scales: list[float]) -> SitkProblem:
    fixed, moving = peer.pair((40, 48))
    warp = Warp(Similarity(), np.array(START), peer.frame(fixed))
    return SitkProblem(peer.method(fixed, moving, "linear"), fixed, moving, warp, scales)


def method(scales: list[float], radius: float, seed: int, *, epsilon: float = 1.5e-4):
    theirs = peer.method(*peer.pair((40, 48)), "linear")
    theirs.SetOptimizerAsOnePlusOneEvolutionary(80, epsilon, radius, -1.0, -1.0, seed)
    theirs.SetOptimizerScales(scales)
    return theirs


@pytest.mark.parametrize("seed", [1, 121212, 3_000_000_000])
@pytest.mark.parametrize(("scales", "radius"), SCALES)
def test_walks_the_same_path(scales, radius, seed):
    cost = problem(scales)
    told, final = path(method(scales, radius, seed), cost, START)

    steps, _ = run(OnePlusOne(radius=radius), cost, START, iterations=80, seed=seed)

    assert len({tuple(position) for position, *_ in told}) > 5  # it does move
    # Relative: what the same operations in the same order leave is nothing, 1e-12 is the promise.
    np.testing.assert_allclose([s.params for s in steps], [t[0] for t in told], rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose([s.value for s in steps], [t[1] for t in told], rtol=1e-12)
    np.testing.assert_allclose([s.size for s in steps], [t[2] for t in told], rtol=1e-12)
    np.testing.assert_allclose(steps[-1].params, final, rtol=1e-12, atol=1e-14)


def test_stops_at_the_same_iteration():
    scales, radius = SCALES[2]
    cost = problem(scales)
    told, final = path(method(scales, radius, 5, epsilon=2.7), cost, START)

    steps, reason = run(OnePlusOne(radius=radius, epsilon=2.7), cost, START, seed=5)

    assert 2 < len(told) < 80
    assert len(steps) - len(told) in (0, 1)  # one more where the last child is a success
    assert "epsilon" in reason
    np.testing.assert_allclose(steps[-1].params, final, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5, 6])
def test_keeps_a_success_of_the_iteration_that_stops(seed):
    scales, radius = SCALES[2]
    cost = problem(scales)
    _, final = path(method(scales, radius, seed, epsilon=50.0), cost, START)

    steps, _ = run(OnePlusOne(radius=radius, epsilon=50.0), cost, START, seed=seed)

    ended = steps[-1].params if steps else np.array(START)
    np.testing.assert_allclose(ended, final, rtol=1e-12, atol=1e-14)
