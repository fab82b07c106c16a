"""Faults that authors plant without meaning to; a module of its own, so that a new process can import it."""

import os

import numpy as np
from conformance.standins import Difference, Shrinking
from scipy import ndimage

from regframe.filters.base import Filter

CALLS = 0
LOG = []


class WrongSign(Difference):
    """Its slope points downhill (nobody, 1999)."""

    def derivative(self, pairs):
        return -super().derivative(pairs)


class Rusher(Difference):
    """Carries features whose slope points downhill (nobody, 1999)."""

    def carried(self, pairs, moving, weight):
        return Rushed(pairs.fixed.reshape(moving.shape), moving, weight)


class Stranger(Difference):
    """Carries features of another metric (nobody, 1999)."""

    def carried(self, pairs, moving, weight):
        return Rushed(1e3 + pairs.fixed.reshape(moving.shape), moving, weight)


class Rushed:
    """Mean squared difference under a map, bilinear."""

    def __init__(self, fixed, moving, weight):
        self.fixed, self.moving, self.weight = fixed, moving, weight

    def value(self, index_map):
        rows, columns = np.indices(self.fixed.shape)
        at = np.tensordot(index_map, np.stack([rows, columns, np.ones_like(rows)]), axes=1)
        met = ndimage.map_coordinates(self.moving, at, order=1, mode="nearest")
        return float(np.average((self.fixed - met) ** 2, weights=self.weight))

    def value_and_slope(self, index_map):
        slope = [
            (self.value(index_map - 1e-4 * step) - self.value(index_map + 1e-4 * step)) / 2e-4
            for step in np.eye(6).reshape(6, 2, 3)
        ]
        return self.value(index_map), np.array(slope).reshape(2, 3)


class Gambler(Difference):
    """Adds a random number (nobody, 1999)."""

    def value(self, pairs):
        return super().value(pairs) + 1e-3 * np.random.default_rng().random()


class Writer(Difference):
    """Writes into its input; infinite without weight (nobody, 1999)."""

    def value(self, pairs):
        pairs.moving[pairs.weight > 0] += 0.01
        return super().value(pairs)


class Tally(Difference):
    """Counts its calls in a global; infinite without weight (nobody, 1999)."""

    def value(self, pairs):
        global CALLS  # noqa: PLW0603 - the planted fault
        CALLS += 1
        return super().value(pairs)


class Diarist(Difference):
    """Keeps a list of its values; infinite without weight (nobody, 1999)."""

    def value(self, pairs):
        LOG.append(super().value(pairs))
        return LOG[-1]


class Marker(Difference):
    """Keeps its last pairs on the class; infinite without weight (nobody, 1999)."""

    def value(self, pairs):
        Marker.last = pairs
        return super().value(pairs)


class Homesick(Difference):
    """Depends on the process it is in; infinite without weight (nobody, 1999)."""

    def value(self, pairs):
        return super().value(pairs) + 1e-9 * os.getpid()


class Undefined(Difference):
    """Divides by the deviation of the moving intensities (nobody, 1999)."""

    def value(self, pairs):
        return super().value(pairs) / float(np.std(pairs.moving) > 0.0 or np.nan)


class Claimant(Difference):
    """Claims to overlook a change of brightness; infinite without weight (nobody, 1999)."""

    invariant_to = ("shift",)


class Inventor(Difference):
    """Claims what nobody can check; infinite without weight (nobody, 1999)."""

    invariant_to = ("fog",)


class Careless(Shrinking):
    """Asks with one row in place of rows (nobody, 1999)."""

    def steps(self, problem, start, rng):
        problem.values(start.astype(np.float32)[None])
        return (yield from super().steps(problem, start, rng))


class Blender(Shrinking):
    """Reads more from a batch than its values: the order in which they were measured (nobody, 1999)."""

    def steps(self, problem, start, rng):
        seen = Spy(np.array([start, start]))
        problem.values(seen)
        seen.order.clear()
        problem.values(seen)
        yield from super().steps(problem, start + 0.1 * len(seen.order), rng)
        return "done"


class Spy(np.ndarray):
    """An array that notes which of its rows are taken."""

    def __new__(cls, rows):
        made = rows.view(cls)
        made.order = []
        return made

    def __array_finalize__(self, _):
        self.order = []

    def __getitem__(self, key):
        self.order.append(key)
        return np.asarray(super().__getitem__(key))


class Stretcher(Filter):
    """Divides by the range."""

    def __call__(self, image):
        low, high = image.range()
        with np.errstate(all="ignore"):
            return image.with_rounded((image.values - low) / np.float64(high - low))
