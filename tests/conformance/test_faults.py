"""Faults planted one at a time are found, each by the check that is there for it."""

from time import sleep

import numpy as np
import pytest
from conformance.standins import Difference, Shrinking, Stretch, Tent
from pydantic import ConfigDict, Field, PrivateAttr

from regframe.component import Component
from regframe.errors import PresetError
from regframe.filters.base import Filter
from regframe.geometry import AffineMap
from regframe.optimizers.base import Step
from regframe.testing.checks import checks_for, conformance, verify


def faults(component):
    """Names of the checks that fail, each with its message."""
    return {verdict.name: verdict.message for verdict in verify(component) if not verdict.passed}


class WrongSign(Difference):
    """Its slope points downhill (nobody, 1999)."""

    def derivative(self, pairs):
        return -super().derivative(pairs)


class HalfSlope(Difference):
    """Its slope is half the true one (nobody, 1999)."""

    def derivative(self, pairs):
        return 0.5 * super().derivative(pairs)


class SlopeOfTheWeightless(Difference):
    """Its slope forgets the weight; infinite without weight (nobody, 1999)."""

    def derivative(self, pairs):
        return 2.0 * (pairs.moving - pairs.fixed) / (pairs.weight.sum() or 1.0)


class Writer(Difference):
    """Centres its input in place; infinite without weight (nobody, 1999)."""

    def value(self, pairs):
        value = super().value(pairs)
        pairs.moving[pairs.weight > 0] += 0.01
        return value


class Gambler(Difference):
    """Adds a random number (nobody, 1999)."""

    def value(self, pairs):
        return super().value(pairs) + 1e-3 * np.random.default_rng().random()


class Forgetful(Difference):
    """Keeps the pairs it is working on in one place for all threads (nobody, 1999)."""

    def value(self, pairs):
        Forgetful.shelf = pairs
        sleep(0.005)
        return super().value(Forgetful.shelf)


class Weightless(Difference):
    """Counts every sample alike (nobody, 1999)."""

    def value(self, pairs):
        return float(((pairs.fixed - pairs.moving) ** 2).mean())


class Total(Difference):
    """A sum where a mean is meant; infinite without weight (nobody, 1999)."""

    def value(self, pairs):
        return float((pairs.weight * (pairs.fixed - pairs.moving) ** 2).sum()) or float("inf")


class InOrder(Difference):
    """Compares neighbours in the list of samples; infinite without weight (nobody, 1999)."""

    def value(self, pairs):
        seen = pairs.weight > 0
        return super().value(pairs) + float(np.abs(np.diff(pairs.moving[seen])).sum())


class Likeness(Difference):
    """Higher is better, infinite without weight (nobody, 1999)."""

    def value(self, pairs):
        value = super().value(pairs)
        return -value if np.isfinite(value) else value


class Boaster(Difference):
    """Claims to see through inverted contrast; infinite without weight (nobody, 1999)."""

    suits = ("mono", "inverted")


class Undefined(Difference):
    """Divides by the spread of the moving intensities (nobody, 1999)."""

    def value(self, pairs):
        return super().value(pairs) / (pairs.moving.max() - pairs.moving.min()) * 0.0 + np.std(
            pairs.moving
        ) / np.std(pairs.moving)


class Raiser(Difference):
    """Refuses flat images (nobody, 1999)."""

    def value(self, pairs):
        if pairs.moving.min() == pairs.moving.max():
            message = "flat"
            raise ValueError(message)
        return super().value(pairs)


class Optimist(Difference):
    """Nothing to compare is a perfect match (nobody, 1999)."""

    def value(self, pairs):
        return super().value(pairs) if pairs.weight.any() else 0.0


METRIC_FAULTS = [
    (WrongSign, "derivative matches differences"),
    (HalfSlope, "derivative matches differences"),
    (SlopeOfTheWeightless, "ignores weightless samples"),
    (Writer, "leaves its input alone"),
    (Writer, "is deterministic"),
    (Gambler, "is deterministic"),
    (Forgetful, "is thread safe"),
    (Weightless, "ignores weightless samples"),
    (Weightless, "counts only weighted samples"),
    (Total, "weight scale does not matter"),
    (InOrder, "sample order does not matter"),
    (Likeness, "prefers alignment"),
    (Boaster, "prefers alignment"),
    (Undefined, "survives constant images"),
    (Raiser, "survives constant images"),
    (Optimist, "survives no overlap"),
]


class WrongAffine(Stretch):
    """Its matrix forgets the centre."""

    def as_affine(self, params, frame):
        return AffineMap(params[0] * np.eye(frame.dim), params[1:].copy())


class MovedIdentity(Stretch):
    """Its identity is a small shift."""

    def identity(self, frame):
        return np.array([1.0, *np.full(frame.dim, 0.01)])


class WrongWay(Stretch):
    """Its gradient points the other way."""

    def parameter_gradient(self, params, points, forces, frame):
        return -super().parameter_gradient(params, points, forces, frame)


class LongShift(Stretch):
    """Its shift is that of the radius squared."""

    def shift(self, params, frame):
        return super().shift(params, frame) ** 2


class LostScale(Stretch):
    """Starts from an affine map without its scale."""

    def from_affine(self, affine, frame):
        return np.array([1.0, *super().from_affine(affine, frame)[1:]])


class Idle(Stretch):
    """Its second parameter does nothing."""

    def map(self, params, points, frame):
        return super().map(np.array([params[0], 0.0, *params[2:]]), points, frame)

    def as_affine(self, params, frame):
        return super().as_affine(np.array([params[0], 0.0, *params[2:]]), frame)


class Namesakes(Stretch):
    """Two parameters of one name."""

    def names(self, frame):
        return ("scale", *["t"] * frame.dim)


class PointWriter(Stretch):
    """Maps the points in place."""

    def map(self, params, points, frame):
        points += 0.0
        points[:] = super().map(params, points, frame)
        return points


class Crowd(Stretch):
    """Measures from the middle of the points, not from the centre."""

    def map(self, params, points, frame):
        return super().map(params, points, frame) + points.mean(axis=0) - frame.centre


TRANSFORM_FAULTS = [
    (WrongAffine, "as affine equals map"),
    (MovedIdentity, "identity moves nothing"),
    (WrongWay, "parameter gradient matches differences"),
    (LongShift, "shift matches motion"),
    (LostScale, "from affine restores as affine"),
    (LostScale, "inverse undoes"),
    (Idle, "every parameter moves something"),
    (Namesakes, "names fit the parameters"),
    (PointWriter, "leaves its input alone"),
    (Crowd, "maps points one by one"),
]


class HalfPixel(Tent):
    """Counts from the pixels' corners."""

    def sample(self, coefficients, indices):
        return super().sample(coefficients, indices - 0.5)


class Swapped(Tent):
    """Its slopes come x first."""

    def gradient(self, coefficients, indices):
        return super().gradient(coefficients, indices)[:, ::-1]


class Leaky(Tent):
    """Weighs neighbours so that they sum to a little more than one between pixels."""

    def sample(self, coefficients, indices):
        return super().sample(coefficients, indices) * (
            1.0 + 0.01 * np.abs(indices - np.rint(indices)).sum(axis=1)
        )


class Clipped(Tent):
    """Ends at the last pixel's centre."""

    def resample(self, coefficients, samples, index_map):
        values, weights = super().resample(coefficients, samples, index_map)
        indices = samples.all_indices()
        short = np.all((indices >= 0) & (indices <= np.array(coefficients.shape) - 1), axis=1)
        return values * short, weights * short


class Transposed(Tent):
    """Its fused map is applied to x first indices as if they were in array order."""

    def resample(self, coefficients, samples, index_map):
        turned = None if index_map is None else index_map.reversed_axes()
        return super().resample(coefficients, samples, turned)


class LostOffset(Tent):
    """Its fused pull-back forgets the offset's slope."""

    def pull_back(self, coefficients, samples, index_map, forces):
        pulled = super().pull_back(coefficients, samples, index_map, forces)
        pulled[:, -1] = 0.0
        return pulled


class Rounder(Tent):
    """Prepares the image in place."""

    def prepare(self, volume):
        volume += 1e-12
        return volume


class Sharp(Tent):
    """Not linear in the image."""

    def sample(self, coefficients, indices):
        return np.maximum(super().sample(coefficients, indices), 50.0)


INTERPOLATOR_FAULTS = [
    (HalfPixel, "exact at samples"),
    (Swapped, "gradient is the slope of sample"),
    (Leaky, "keeps a constant"),
    (Clipped, "knows its borders"),
    (Transposed, "resample equals its default"),
    (LostOffset, "pull back equals its default"),
    (Rounder, "leaves its input alone"),
    (Sharp, "is linear in the image"),
]


class Unseeded(Shrinking):
    """Draws from its own source of chance (nobody, 1999)."""

    def steps(self, problem, start, rng):
        return (yield from super().steps(problem, start, np.random.default_rng()))


class Wanderer(Shrinking):
    """Keeps every step, good or bad (nobody, 1999)."""

    def steps(self, problem, start, rng):
        here = start.copy()
        while True:
            here = here + 0.5 * rng.standard_normal(len(here))
            yield Step(here, float(problem.values(here[None])[0]), 0.5)


class Lazy(Shrinking):
    """Gives up after ten steps (nobody, 1999)."""

    def steps(self, problem, start, rng):
        walker = super().steps(problem, start, rng)
        for _ in range(10):
            yield next(walker)
        return "tired"


class Silent(Shrinking):
    """Stops without a word (nobody, 1999)."""

    def steps(self, problem, start, rng):
        yield from super().steps(problem, start, rng)


class StartWriter(Shrinking):
    """Works in the array it was given (nobody, 1999)."""

    def steps(self, problem, start, rng):
        for step in super().steps(problem, start.copy(), rng):
            start[:] = step.params
            yield step
        return "done"


class OneArray(Shrinking):
    """Yields the same array again and again (nobody, 1999)."""

    def steps(self, problem, start, rng):
        shared = start.copy()
        for step in super().steps(problem, start, rng):
            shared[:] = step.params
            yield Step(shared, step.value, step.size)
        return "done"


class Uphill(Shrinking):
    """Follows the slope the wrong way (nobody, 1999)."""

    def steps(self, problem, start, rng):
        here = start.copy()
        while np.abs(here).max() < 1e6:
            value, slope = problem.value_and_gradient(here)
            here = here + 0.1 * slope
            yield Step(here, value, 0.1)
        return "far away"


class Fragile(Shrinking):
    """Cannot bear an infinite value (nobody, 1999)."""

    def steps(self, problem, start, rng):
        for step in super().steps(problem, start, rng):
            probe = start + 3.0 * rng.standard_normal(len(start))
            if not np.isfinite(problem.values(probe[None])[0]):
                message = "lost"
                raise ArithmeticError(message)
            yield step
        return "done"


OPTIMIZER_FAULTS = [
    (Unseeded, "same seed same steps"),
    (Wanderer, "never worse than its start"),
    (Wanderer, "ends at the bottom of a bowl"),
    (Lazy, "ends at the bottom of a bowl"),
    (Lazy, "walks a curved valley"),
    (Silent, "names its stop reason"),
    (StartWriter, "leaves its start alone"),
    (OneArray, "leaves its start alone"),
    (Uphill, "ends at the bottom of a bowl"),
    (Fragile, "accepts infinite values"),
]


class Vague(Difference):
    power: float = Field(2.0)


class Open(Difference):
    """Takes any option; infinite without weight (nobody, 1999)."""

    model_config = ConfigDict(extra="ignore")


class Hoarder(Difference):
    """Remembers things; infinite without weight (nobody, 1999)."""

    _seen: list = PrivateAttr(default_factory=list)


class Uncited(Difference):
    """Some measure, infinite without weight."""


class Smudge(Filter):
    """Writes into its input."""

    def __call__(self, image):
        image.values[:] += 1.0
        return image


class Unmasking(Filter):
    """Drops the mask."""

    def __call__(self, image):
        return image.with_mask(None)


COMMON_FAULTS = [
    (Vague, "describes its options"),
    (Vague, "says what it is"),
    (Open, "is frozen and closed"),
    (Hoarder, "is frozen and closed"),
    (Uncited, "cites its source"),
    (Smudge, "leaves its input alone"),
    (Unmasking, "keeps grid and mask"),
]


@pytest.mark.parametrize("standin", [Difference, Stretch, Tent, Shrinking], ids=lambda c: c.__name__)
def test_an_honest_component_has_no_fault(standin):
    assert faults(standin()) == {}


@pytest.mark.parametrize(
    ("faulty", "check"),
    [*METRIC_FAULTS, *TRANSFORM_FAULTS, *INTERPOLATOR_FAULTS, *OPTIMIZER_FAULTS, *COMMON_FAULTS],
    ids=lambda value: value.__name__ if isinstance(value, type) else value,
)
def test_a_planted_fault_is_found(faulty, check):
    found = {one.name: one for one in checks_for(faulty())}[check]

    with pytest.raises((AssertionError, ArithmeticError)):
        found.run()


def test_a_class_inside_a_function_cannot_be_pickled():
    class Local(Difference):
        """Nobody can find it (nobody, 1999)."""

    assert "Define the class in a module" in faults(Local())["survives pickling"]


def test_a_wrong_modality_is_named():
    class Unclear(Difference):
        """Suits something else (nobody, 1999)."""

        suits = ("night",)

    assert "Got night" in faults(Unclear())["prefers alignment"]


def test_a_wrong_slope_is_told_with_numbers():
    message = faults(WrongSign())["derivative matches differences"]

    assert "not the slope of `value`" in message
    assert "expected" in message


def test_a_fault_that_raises_is_a_verdict():
    assert faults(Fragile())["accepts infinite values"] == "raises ArithmeticError: lost"


def test_what_does_not_apply_passes_with_its_reason():
    class ByDifferences(Difference):
        """Leaves its slope to the engine (nobody, 1999)."""

        def derivative(self, pairs):
            return None

    verdicts = {verdict.name: verdict for verdict in verify(ByDifferences())}

    assert verdicts["derivative matches differences"].passed
    assert verdicts["derivative matches differences"].outcome == "does not apply"


def test_other_things_have_no_checks():
    class Thing(Component):
        """Of no kind."""

    with pytest.raises(PresetError, match="no checks for a Thing"):
        checks_for(Thing())


def test_conformance_is_a_pytest_function():
    test = conformance(Stretch(), Tent())

    cases = test.pytestmark[0].args[1]
    assert len(cases) == len(checks_for(Stretch())) + len(checks_for(Tent()))


def test_every_check_says_its_claim():
    unsaid = [
        check.name
        for part in (Difference, Stretch, Tent, Shrinking)
        for check in checks_for(part())
        if not check.about
    ]

    assert unsaid == []
