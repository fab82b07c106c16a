"""What a component does with known inputs, as arrays that can be compared bit by bit."""

from collections.abc import Iterator

import numpy as np

from regframe.component import Component
from regframe.errors import PresetError
from regframe.filters.base import Filter
from regframe.geometry import AffineMap
from regframe.interpolators.base import Interpolator, Samples
from regframe.metrics.base import Metric
from regframe.optimizers.base import Optimizer
from regframe.testing import metric_checks, optimizer_checks, transform_checks
from regframe.testing.phantoms import smooth_pair
from regframe.transforms.base import Transform
from regframe.types import Values

Seen = list[Values]

SHAPES = ((14, 17), (6, 7, 8))
STEPS = 40


def observe(component: Component, seed: int = 1) -> Seen:
    """Everything the component gives for inputs that the seed decides.

    Examples
    --------
    >>> from regframe.filters.invert import Invert
    >>> [array.shape for array in observe(Invert())]
    [(14, 17), (6, 7, 8)]
    """
    for look in (_metric, _transform, _interpolator, _filter, _optimizer):
        seen = list(look(component, seed))
        if seen:
            return seen
    message = f"nothing is known to be tried with a {type(component).__name__}"
    raise PresetError(message)


def same(one: Seen, other: Seen) -> bool:
    """Whether two observations are equal to the last bit; NaN equals NaN."""
    pairs = zip(one, other, strict=False)
    return len(one) == len(other) and all(np.array_equal(a, b, equal_nan=True) for a, b in pairs)


def _metric(metric: Component, seed: int) -> Iterator[Values]:
    if not isinstance(metric, Metric):
        return
    for shift in ((0, 0), (0, 2)):
        pairs = metric_checks.prepared(metric, metric_checks.example_pairs(shift=shift, seed=seed))
        slopes = metric.derivative(pairs)
        yield np.array([metric.value(pairs)])
        yield np.zeros(0) if slopes is None else slopes.copy()


def _transform(transform: Component, seed: int) -> Iterator[Values]:
    if not isinstance(transform, Transform):
        return
    for dim in transform.dimensions:
        frame = transform_checks.example_frame(dim)
        params = transform_checks.example_params(transform, frame, seed=seed)
        points = frame.grid.points(frame.grid.all_indices())
        yield transform.map(params, points, frame).copy()
        yield transform.parameter_gradient(params, points, np.cos(points), frame).copy()


def _interpolator(interpolator: Component, seed: int) -> Iterator[Values]:
    if not isinstance(interpolator, Interpolator):
        return
    for shape in SHAPES:
        rng = np.random.default_rng((seed, len(shape)))
        coefficients = interpolator.prepare(100.0 * rng.random(shape))
        indices = rng.uniform(0.0, np.array(shape) - 1.0, (50, len(shape)))
        yield interpolator.sample(coefficients, indices).copy()
        moved = AffineMap(np.eye(len(shape)), np.full(len(shape), 0.3))
        yield from (part.copy() for part in interpolator.resample(coefficients, Samples(shape), moved))


def _filter(given: Component, seed: int) -> Iterator[Values]:
    if not isinstance(given, Filter):
        return
    for shape in SHAPES:
        yield np.array(given(smooth_pair("mono", shape, seed=seed).fixed).values, np.float64)


def _optimizer(optimizer: Component, seed: int) -> Iterator[Values]:
    if not isinstance(optimizer, Optimizer):
        return
    start = optimizer_checks.START / seed
    steps, _ = optimizer_checks.walk(optimizer, optimizer_checks.Bowl(), start, iterations=STEPS, seed=seed)
    yield start
    yield from (np.array([*step.params, step.value]) for step in steps)
