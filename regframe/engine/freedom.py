"""Which parameters a search may change, and how far it follows the slopes of each."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from regframe.engine.followed import alone
from regframe.errors import PresetError
from regframe.faults import nearest
from regframe.geometry import Frame
from regframe.optimizers.base import Problem
from regframe.preset import Stage
from regframe.types import Mask, Params, Values


@dataclass(frozen=True, eq=False)
class Freedom:
    """What a stage says of its parameters.

    Parameters
    ----------
    free : (p,) bool
        False for parameters that stay as they are.
    weights : (p,) float64
        Factors on the slopes; 0 where a parameter is not free.
    """

    free: Mask
    weights: Params


def freedom(stage: Stage, frame: Frame, count: int) -> Freedom:
    """The freedom of a stage's `count` parameters.

    Raises
    ------
    PresetError
        Weights of another number, a name that no parameter has, or none left to search.
    """
    free, weights = np.ones(count, bool), np.ones(count)
    if stage.weights is not None:
        weights = listed("weights", stage.weights, stage, frame, count)
    if stage.frozen:
        free = ~_marked(stage, frame)
        weights = np.where(free, weights, 0.0)
    if not weights.any():
        message = (
            "stages: every parameter is frozen or has the weight 0, so there is nothing to search. "
            "Leave one free."
        )
        raise PresetError(message)
    return Freedom(free, weights)


def listed(what: str, numbers: tuple[float, ...], stage: Stage, frame: Frame, count: int) -> Params:
    """A stage's list of numbers, one a parameter; of families of points, one an axis.

    Raises
    ------
    PresetError
        Another number of them.
    """
    local = alone(stage.transform).local
    wanted = frame.dim if local else count
    if len(numbers) != wanted:
        per = "an axis" if local else "a parameter"
        known = "axes" if local else "parameters"
        names = "" if local or count > MOST_NAMES else f" ({', '.join(stage.transform.names(frame))})"
        message = (
            f"stages: {what} has {len(numbers)} numbers and the transform {wanted} {known}{names}. "
            f"Give one number {per}."
        )
        raise PresetError(message)
    return np.tile(np.array(numbers), count // wanted)


def _marked(stage: Stage, frame: Frame) -> Mask:
    names = stage.transform.names(frame)
    for name in stage.frozen:
        if name not in names:
            known = ", ".join(names) if len(names) <= MOST_NAMES else f"{names[0]} to {names[-1]}"
            message = (
                f"stages: frozen: no parameter is called {name!r}.{nearest(name, names)} Those of "
                f"{type(stage.transform).__name__}: {known}."
            )
            raise PresetError(message)
    return np.isin(np.array(names), stage.frozen)


MOST_NAMES = 20


class Shown:
    """A problem of some of another one's coordinates, the others staying where they are.

    Parameters
    ----------
    problem : Problem
    origin : (p,) float64
        Where the others stay.
    free : (p,) bool
    """

    def __init__(self, problem: Problem, origin: Params, free: Mask) -> None:
        self.problem, self.origin, self.free = problem, origin, free
        self.scales, self.weights = problem.scales[free], problem.weights[free]

    def whole(self, at: Params) -> Params:
        """All coordinates, of free ones (..., q)."""
        if len(self.scales) == len(self.origin):
            return at.copy()
        found = np.broadcast_to(self.origin, (*at.shape[:-1], len(self.origin))).copy()
        found[..., self.free] = at
        return found

    def values(self, batch: NDArray[np.float64]) -> Values:
        """Metric at each row of a (b, q) batch."""
        return self.problem.values(self.whole(batch))

    def value_and_gradient(self, at: Params) -> tuple[float, Params]:
        """Metric, and its slope by the free coordinates."""
        value, slope = self.problem.value_and_gradient(self.whole(at))
        return value, slope[self.free]

    def advance(self, at: Params, step: Params) -> Params:
        """The position after a step."""
        return self.problem.advance(self.whole(at), self._still(step))[self.free]

    def motion(self, at: Params, step: Params) -> float:
        """Largest motion that a step makes over the grid."""
        return self.problem.motion(self.whole(at), self._still(step))

    def _still(self, step: Params) -> Params:
        if len(self.scales) == len(self.origin):
            return step
        found = np.zeros_like(self.origin)
        found[self.free] = step
        return found


def shown(problem: Problem, stage: Stage, at: Params, free: Mask) -> Shown:
    """The problem that an optimizer is given: all coordinates where it weighs slopes, else the free ones."""
    return Shown(problem, at, np.ones_like(free) if stage.optimizer.weighs else free)
