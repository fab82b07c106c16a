"""What every optimizer must hold, on landscapes whose lowest point is known."""

from pickle import dumps, loads

import numpy as np
from numpy.typing import NDArray

from regframe.errors import NoOverlapError
from regframe.optimizers.base import Optimizer, Problem, Step
from regframe.testing.claims import NotApplicable, require, unchanged
from regframe.types import Params, Values

START = np.array([8.0, -5.0, 3.0, 6.0])  # pixels of motion, as a registration that is off by ten
BUDGET = 2000


class Bowl:
    """A quadratic in pixels of motion, lowest (0) at the origin, like a metric near its optimum.

    Parameters
    ----------
    fence : float
        Beyond this distance nothing overlaps.
    noise : float
        Deviation of a disturbance of every value, drawn anew.
    """

    def __init__(self, dim: int = 4, *, fence: float = np.inf, noise: float = 0.0) -> None:
        self.scales: Params = np.ones(dim)
        self.weights: Params = np.ones(dim)
        self.curvature = np.linspace(0.5, 2.0, dim)
        self.fence, self.noise = fence, noise
        self.rng = np.random.default_rng(17)

    def values(self, batch: NDArray[np.float64]) -> Values:
        """Height at each row, infinite beyond the fence."""
        heights = (self.curvature * batch**2).sum(axis=1) + self.noise * self.rng.standard_normal(len(batch))
        return np.where(np.sqrt((batch**2).sum(axis=1)) > self.fence, np.inf, heights)

    def value_and_gradient(self, at: Params) -> tuple[float, Params]:
        """Height and slope at one place."""
        value = float(self.values(at[None])[0])
        if not np.isfinite(value):
            message = "the images share nothing to compare there"
            raise NoOverlapError(message)
        return value, 2 * self.curvature * at + self.noise * self.rng.standard_normal(len(at))

    def advance(self, at: Params, step: Params) -> Params:
        """The sum."""
        return at + step

    def motion(self, at: Params, step: Params) -> float:
        """Length of a step."""
        return float(np.sqrt((step**2).sum()))


class OneByOne(Bowl):
    """The same bowl, measured row by row from the last to the first, as another machine might share them."""

    def values(self, batch: NDArray[np.float64]) -> Values:
        """Height at each row; the batch must be rows of finite float64, one number a parameter."""
        count = len(self.scales)
        fits = isinstance(batch, np.ndarray) and batch.ndim == 2 and batch.shape[1] == count
        require(
            fits and batch.dtype == np.float64,
            f"`problem.values` takes float64 rows, (b, {count}). Got {getattr(batch, 'dtype', type(batch))} "
            f"of shape {np.shape(batch)}.",
        )
        heights = np.empty(len(batch))
        for i in reversed(range(len(batch))):
            heights[i] = super().values(batch[i : i + 1].copy())[0]
        return heights


class Valley(Bowl):
    """Rosenbrock's curved valley, lowest (0) at (1, 1)."""

    def __init__(self) -> None:
        super().__init__(2)

    def values(self, batch: NDArray[np.float64]) -> Values:
        """Height at each row."""
        x, y = batch.T
        return np.asarray((1 - x) ** 2 + 100 * (y - x * x) ** 2)

    def value_and_gradient(self, at: Params) -> tuple[float, Params]:
        """Height and slope at one place."""
        x, y = at
        slope = np.array([-2 * (1 - x) - 400 * x * (y - x * x), 200 * (y - x * x)])
        return float(self.values(at[None])[0]), slope


class Plain(Bowl):
    """Flat: the same value everywhere, and no slope."""

    def values(self, batch: NDArray[np.float64]) -> Values:
        """Five, everywhere."""
        return np.full(len(batch), 5.0)

    def value_and_gradient(self, at: Params) -> tuple[float, Params]:
        """Five and no slope."""
        return 5.0, np.zeros_like(at)


def walk(
    optimizer: Optimizer, problem: Problem, start: Params, *, iterations: int = BUDGET, seed: int = 1
) -> tuple[list[Step], str | None]:
    """Every step up to a budget, and why the optimizer stopped; None where the budget ended it.

    A stop without a reason gives an empty one.

    Examples
    --------
    >>> from regframe.optimizers.one_plus_one import OnePlusOne
    >>> steps, reason = walk(OnePlusOne(), Bowl(), START, iterations=5)
    >>> len(steps), reason
    (5, None)
    """
    walker = optimizer.steps(problem, start, optimizer.normals(seed))
    steps: list[Step] = []
    while len(steps) < iterations:
        try:
            steps.append(next(walker))
        except StopIteration as stop:
            return steps, "" if stop.value is None else stop.value
    return steps, None


def check_same_seed_same_steps(optimizer: Optimizer) -> None:
    """A seed decides every bit of the walk, for this object and for a copy of it."""
    first, _ = walk(optimizer, Bowl(), START, iterations=50)
    for name, again in (("a second run", optimizer), ("a copy", loads(dumps(optimizer)))):
        other, _ = walk(again, Bowl(), START, iterations=50)
        same = len(first) == len(other) and all(
            np.array_equal(one.params, two.params) and one.value == two.value
            for one, two in zip(first, other, strict=True)
        )
        require(
            same, f"With the same seed, {name} takes other steps. Draw only from `rng`; keep state local."
        )


def check_two_walks_do_not_mix(optimizer: Optimizer) -> None:
    """Two walks of one optimizer, step by step in turn, are as they would be alone."""
    alone, _ = walk(optimizer, Bowl(), START, iterations=20)
    walkers = [optimizer.steps(Bowl(), START, optimizer.normals(1)) for _ in range(2)]
    for wanted, *met in zip(alone, *walkers, strict=False):
        same = all(np.array_equal(step.params, wanted.params) for step in met)
        require(same, "Two walks of one optimizer disturb each other. Keep state in local variables.")


def check_batch_order_does_not_matter(optimizer: Optimizer) -> None:
    """Rows of a batch may be measured together, or one at a time in any order."""
    together, _ = walk(optimizer, Bowl(), START, iterations=50)
    apart, _ = walk(optimizer, OneByOne(), START, iterations=50)
    same = len(together) == len(apart) and all(
        np.array_equal(one.params, two.params) for one, two in zip(together, apart, strict=False)
    )
    require(same, "The walk changes when the rows of a batch are measured one by one, the last one first.")


def check_never_worse_than_its_start(optimizer: Optimizer) -> None:
    """Wherever the budget ends the run, the last step's place is no higher than the start."""
    for budget in (1, 3, 30, 300):
        for start in (START, 0.05 * START):
            problem = Bowl()
            steps, _ = walk(optimizer, problem, start, iterations=budget)
            before = float(problem.values(start[None])[0])
            after = _height(problem, steps, start)
            require(
                after <= before,
                f"After {budget} iterations from {start.tolist()} the value is {after:.6g}, at the start it "
                f"was {before:.6g}. Yield the best position met.",
            )


def check_ends_at_the_bottom_of_a_bowl(optimizer: Optimizer) -> None:
    """From ten pixels off, the walk ends within half a pixel of the bottom, in 2, 4 and 6 parameters."""
    _must_walk(optimizer)
    for dim in (2, 4, 6):
        start = np.resize(START, dim)
        steps, reason = walk(optimizer, Bowl(dim), start)
        away = float(np.sqrt((_end(steps, start) ** 2).sum()))
        require(
            away < 0.5,
            f"In {dim} parameters the walk ends {away:.3g} px from a bowl's bottom after {len(steps)} steps "
            f"({reason or 'the budget ended'}). Check its step length and direction: slopes point uphill.",
        )


def check_walks_a_curved_valley(optimizer: Optimizer) -> None:
    """On Rosenbrock's valley the walk gets to a third of its first height."""
    _must_walk(optimizer)
    start, problem = np.array([-1.2, 1.0]), Valley()
    before = float(problem.values(start[None])[0])
    steps, reason = walk(optimizer, problem, start)
    after = _height(problem, steps, start)
    require(
        after < before / 3,
        f"On Rosenbrock's valley the value falls from {before:.4g} only to {after:.4g} in {len(steps)} steps "
        f"({reason or 'the budget ended'}).",
    )


def check_survives_noise(optimizer: Optimizer) -> None:
    """Disturbed values and slopes raise nothing and leave a finite position."""
    steps, _ = walk(optimizer, Bowl(noise=3.0), START, iterations=300)
    wrong = [step for step in steps if not np.isfinite(step.params).all() or np.isnan(step.value)]
    require(not wrong, f"On a noisy bowl a step is no number: {wrong[:1]}.")


def check_accepts_infinite_values(optimizer: Optimizer) -> None:
    """Places where nothing overlaps are passed by, not reported."""
    problem = Bowl(fence=1.15 * float(np.sqrt((START**2).sum())))
    try:
        steps, _ = walk(optimizer, problem, START, iterations=500)
    except NoOverlapError as error:
        message = (
            f"The walk leaves the overlap on a plain bowl: {error}. Refuse steps whose value is infinite."
        )
        raise AssertionError(message) from error
    after, before = _height(problem, steps, START), float(problem.values(START[None])[0])
    require(
        after < before, f"Beside infinite values the walk makes no progress: {before:.4g}, then {after:.4g}."
    )


def check_names_its_stop_reason(optimizer: Optimizer) -> None:
    """Where the walk ends by itself it returns a sentence."""
    for name, problem in (("a flat plain", Plain()), ("a bowl", Bowl())):
        _, reason = walk(optimizer, problem, START, iterations=2 * BUDGET)
        if reason is None:
            continue
        require(
            isinstance(reason, str) and bool(reason.strip()),
            f"On {name} the walk ends without a reason: `return` a sentence from `steps`. Got {reason!r}.",
        )
        return
    message = f"the optimizer goes on for more than {2 * BUDGET} steps; the engine's budget ends it"
    raise NotApplicable(message)


def check_leaves_its_start_alone(optimizer: Optimizer) -> None:
    """The start is not written into, and no step changes after it was told."""
    start = START.copy()
    walker = optimizer.steps(Bowl(), start, optimizer.normals(1))
    told = [(step, step.params.copy()) for step, _ in zip(walker, range(30), strict=False)]
    require(unchanged(START, start), "`steps` writes into its start. Copy before changing.")
    changed = [i for i, (step, kept) in enumerate(told) if not unchanged(kept, step.params)]
    require(not changed, f"Steps {changed[:3]} change after they were yielded. Yield arrays of their own.")


def check_tells_where_it_stands(optimizer: Optimizer) -> None:
    """A step holds one float64 a parameter, a float value and a size of 0 or more."""
    steps, _ = walk(optimizer, Bowl(), START, iterations=30)
    require(bool(steps), "No step is made on a bowl.")
    for step in steps:
        require(
            step.params.shape == START.shape and step.params.dtype == np.float64,
            f"A step's params must be float64 {START.shape}. Got {step.params.dtype} {step.params.shape}.",
        )
        require(step.size >= 0.0, f"A step's size must be 0 or more. Got {step.size!r}.")
        require(np.isfinite(step.value), f"On a bowl a step's value must be finite. Got {step.value!r}.")


def check_heeds_weights(optimizer: Optimizer) -> None:
    """One that says it weighs slopes keeps a coordinate of weight 0, to the last bit."""
    if not optimizer.weighs:
        message = "the optimizer does not multiply slopes by weights"
        raise NotApplicable(message)
    problem = Bowl()
    problem.weights[1] = 0.0
    steps, _ = walk(optimizer, problem, START, iterations=30)
    moved = [i for i, step in enumerate(steps) if step.params[1] != START[1]]
    require(
        not moved, f"A coordinate of weight 0 moves at steps {moved[:3]}. Multiply slopes by problem.weights."
    )
    require(bool(steps) and steps[-1].params[0] != START[0], "With one weight of 0 nothing moves at all.")


CHECKS = (
    check_tells_where_it_stands,
    check_same_seed_same_steps,
    check_two_walks_do_not_mix,
    check_batch_order_does_not_matter,
    check_never_worse_than_its_start,
    check_ends_at_the_bottom_of_a_bowl,
    check_walks_a_curved_valley,
    check_survives_noise,
    check_accepts_infinite_values,
    check_names_its_stop_reason,
    check_leaves_its_start_alone,
    check_heeds_weights,
)


def _must_walk(optimizer: Optimizer) -> None:
    if optimizer.scans:
        message = "the optimizer scans positions near its start, and does not walk"
        raise NotApplicable(message)


def _end(steps: list[Step], start: Params) -> Params:
    return steps[-1].params if steps else start


def _height(problem: Problem, steps: list[Step], start: Params) -> float:
    return float(problem.values(_end(steps, start)[None])[0])
