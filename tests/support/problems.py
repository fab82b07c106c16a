"""Analytic problems for optimizers, in pixels of motion."""

from itertools import islice

import numpy as np

from regframe.errors import NoOverlapError


class Bowl:
    """A quadratic with its lowest point at `target`; nothing overlaps beyond `fence` of it."""

    def __init__(self, target, *, stretch=1.0, fence=np.inf, scales=None):
        self.target = np.array(target, dtype=np.float64)
        self.stretch = np.broadcast_to(stretch, self.target.shape)
        self.fence = fence
        self.weights = np.ones_like(self.target)
        self.scales = np.ones_like(self.target) if scales is None else np.array(scales, dtype=np.float64)
        self.visited = []

    def values(self, batch):
        self.visited.extend(row.copy() for row in batch)
        away = batch - self.target
        values = (self.stretch * away**2).sum(axis=1)
        return np.where(np.sqrt((away**2).sum(axis=1)) > self.fence, np.inf, values)

    def value_and_gradient(self, at):
        value = float(self.values(at[None])[0])
        if not np.isfinite(value):
            message = "nothing overlaps"
            raise NoOverlapError(message)
        return value, 2.0 * self.stretch * (at - self.target)

    def advance(self, at, step):
        return at + step

    def motion(self, at, step):
        return float(np.sqrt((step**2).sum()))


class Rosenbrock(Bowl):
    """The banana valley, lowest at (1, 1)."""

    def __init__(self):
        super().__init__([1.0, 1.0])

    def values(self, batch):
        x, y = batch.T
        return (1.0 - x) ** 2 + 100.0 * (y - x * x) ** 2

    def value_and_gradient(self, at):
        x, y = at
        slope = [-2.0 * (1.0 - x) - 400.0 * x * (y - x * x), 200.0 * (y - x * x)]
        return float(self.values(at[None])[0]), np.array(slope)


def run(optimizer, problem, start, *, iterations=300, seed=1):
    """Every step up to a limit, and the reason to stop, or None at the limit."""
    walk = optimizer.steps(problem, np.array(start, dtype=np.float64), optimizer.normals(seed))
    told, reason = [], None

    def watched():
        nonlocal reason
        reason = yield from walk

    told = list(islice(watched(), iterations))
    return told, reason
