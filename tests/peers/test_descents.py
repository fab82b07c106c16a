"""Gradient descents against SimpleITK's, on SimpleITK's own values and slopes."""

import numpy as np
import pytest

from regframe.optimizers.conjugate_gradient_line_search import ConjugateGradientLineSearch
from regframe.optimizers.convergence import Window
from regframe.optimizers.gradient_descent import GradientDescent
from regframe.optimizers.gradient_descent_line_search import GradientDescentLineSearch
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.problems import run
from support.runs import tell_optimizer
from support.sitk_problems import SitkProblem, path

pytestmark = pytest.mark.usefixtures("one_thread")

DESCENTS = [
    (GradientDescent, "last"),
    (GradientDescentLineSearch, "itk"),
    (ConjugateGradientLineSearch, "itk"),
]
TURNED = [1.03, 0.04, 1.5, -1.0]
LONGEST = 1.5
STOPS = {"convergence_minimum": 1e-5, "convergence_window": 5}


def method(fixed, moving):
    theirs = peer.method(fixed, moving, "linear")
    theirs.SetMetricAsMeanSquares()
    return theirs


def cost(transform, start, scales):
    fixed = peer.pair((32, 40))[0]
    moving = fixed.with_values(np.roll(fixed.values, (2, -1), axis=(0, 1)))
    warp = Warp(transform, np.array(start), peer.frame(fixed))
    return SitkProblem(method(fixed, moving), fixed, moving, warp, scales)


def told_path(optimizer, problem, start, iterations, *, estimated=False):
    theirs = method(*problem.pair)
    tell_optimizer(theirs, optimizer, iterations, LONGEST)
    if estimated:
        theirs.SetOptimizerScalesFromPhysicalShift()
    else:
        theirs.SetOptimizerScales(problem.scales.tolist())
    told, final = path(theirs, problem, start)
    problem.scales = np.array(told[0][4])
    return told, final, theirs


def agree(problem, told, steps, final):
    """Position of each event is where the next slope is taken; 1e-9 is the promise for gradient presets."""
    assert len(steps) == len(told)
    ours = problem.descended[1 : len(told)]
    np.testing.assert_allclose(ours, [t[0] for t in told[: len(ours)]], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(steps[-1].params, final, rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize(("kind", "keep"), DESCENTS)
@pytest.mark.parametrize(
    ("transform", "start", "scales", "rate"),
    [
        (Translation(), [0.0, 0.0], [1.005, 0.995], 2e-3),
        (Similarity(), TURNED, [1400.0, 1500.0, 1.0, 1.0], 1e-3),
    ],
)
def test_walks_the_same_path(kind, keep, transform, start, scales, rate):
    problem = cost(transform, start, scales)
    optimizer = kind(learning_rate=rate, estimate_learning_rate="never", keep=keep, **STOPS)
    told, final, theirs = told_path(optimizer, problem, start, 15)

    steps, reason = run(optimizer, problem, start, iterations=15)

    agree(problem, told, steps, final)
    assert ("Convergence checker" in theirs.GetOptimizerStopConditionDescription()) == bool(reason)


@pytest.mark.parametrize(
    ("kind", "keep", "when"),
    [(kind, keep, "once") for kind, keep in DESCENTS] + [(GradientDescent, "last", "each-iteration")],
)
def test_estimates_the_same_learning_rates(kind, keep, when):
    problem = cost(Similarity(), TURNED, [1.0] * 4)
    optimizer = kind(estimate_learning_rate=when, maximum_step=LONGEST, keep=keep, **STOPS)
    told, final, _ = told_path(optimizer, problem, TURNED, 10, estimated=True)

    steps, _ = run(optimizer, problem, TURNED, iterations=10)

    agree(problem, told, steps, final)


@pytest.mark.parametrize("size", [2, 3, 7, 10, 20])
def test_judges_convergence_by_the_same_number(size):
    problem = cost(Similarity(), TURNED, [1400.0, 1500.0, 1.0, 1.0])
    endless = GradientDescent(
        learning_rate=1e-3,
        estimate_learning_rate="never",
        convergence_minimum=-1e300,
        convergence_window=size,
    )
    told, _, _ = told_path(endless, problem, TURNED, 25)
    window = Window(size)

    ours = [window.push(value) for _, value, *_ in told]

    assert np.isinf(ours[: size - 1]).all()
    # A few operations in double precision on the same single precision weights.
    np.testing.assert_allclose(ours[size - 1 :], [t[2] for t in told[size - 1 :]], rtol=1e-12)
