"""How parameters are improved."""

from abc import abstractmethod
from collections.abc import Generator
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from regframe.component import Component
from regframe.types import Params, Values


@dataclass(frozen=True, slots=True)
class Step:
    """Where an optimizer stands after one iteration.

    Parameters
    ----------
    params : (p,) float64
        The best or current position, in the problem's coordinates.
    value : float
        The metric there, or where the iteration began; `Optimizer.steps` says which.
    size : float
        The length an optimizer calls its step, in the problem's coordinates.
    """

    params: Params
    value: float
    size: float


class Problem(Protocol):
    """All an optimizer may know of what it minimises.

    Coordinates are pixels (or mm) of motion and `scales` are ones, unless the user asked for ITK's
    scales: then coordinates are the transform's parameters and `scales` are ITK's numbers, which each
    optimizer uses as ITK's does. `weights` are factors on the slopes, ones unless the user says otherwise;
    only optimizers that say so in `Optimizer.weighs` are given others.
    """

    scales: Params
    weights: Params

    def values(self, batch: NDArray[np.float64]) -> Values:
        """Metric at each row of a (b, p) batch: (b,), infinite where nothing overlaps."""

    def value_and_gradient(self, at: Params) -> tuple[float, Params]:
        """Metric and its slope (uphill) at one position.

        Raises
        ------
        NoOverlapError
            Nothing overlaps there.
        """

    def advance(self, at: Params, step: Params) -> Params:
        """The position after a step downhill: their sum, but for transforms whose rotations compose."""

    def motion(self, at: Params, step: Params) -> float:
        """Largest motion in pixels (or mm) that a step makes over the grid."""


class Normals(Protocol):
    """A source of normal deviates: numpy's Generator is one."""

    def standard_normal(self, size: int) -> Values:
        """The next `size` deviates."""


class Optimizer(Component):
    """How parameters are improved, one step at a time.

    An optimizer knows no iteration limit, no clock and no image: the engine slices the generator.
    """

    scans: ClassVar[bool] = False
    """Whether it only measures positions laid out about the start, and finds nothing beyond them."""

    weighs: ClassVar[bool] = False
    """Whether it multiplies slopes by the problem's weights, so that a weight of 0 keeps a coordinate.

    Others are not shown the coordinates that a stage freezes.
    """

    @abstractmethod
    def steps(self, problem: Problem, start: Params, rng: Normals) -> Generator[Step, None, str]:
        """Yield a Step an iteration; return the reason when there is nothing left to do.

        The last Step's position is the answer, wherever the engine's budget ends the run; without any Step
        the start is. What only an unneeded next iteration would use is best computed after the yield.
        """

    def normals(self, seed: int) -> Normals:
        """Hook: the generator that a run hands to `steps`; one for all levels of a stage."""
        return np.random.default_rng(seed)
