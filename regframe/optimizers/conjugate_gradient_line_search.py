"""Conjugate gradient descent with a golden section search along each direction."""

from typing import final

import numpy as np

from regframe.optimizers.descent import dot
from regframe.optimizers.line_search import Direction, LineSearchDescent
from regframe.types import Params

_STEEPEST = 5.0
"""ITK forgets the direction before where its share would exceed this."""


@final
class ConjugateGradientLineSearch(LineSearchDescent):
    """Walk downhill along directions that keep what the one before has gained.

    E. Polak and G. Ribiere, "Note sur la convergence de methodes de directions conjuguees", Revue
    francaise d'informatique et de recherche operationnelle 3, 1969, with golden section searches;
    `itk::ConjugateGradientLineSearchOptimizerv4`, whose path it walks. Where the metric is much
    steeper along one direction than along another it needs far fewer iterations than straight descent.

    Four departures from ITK: `keep` says which position is reported; places of the search where nothing
    overlaps are passed by, also where ITK's Mattes metric would abort the run; the learning rate is
    estimated wherever that is asked for, where ITK does so only beside estimated scales; and where it is
    not, each level begins with `learning_rate`, where ITK goes on with the last rate found.
    """

    def direction(self) -> Direction:
        """The slope, and a share of the direction before."""
        return _Conjugate()


class _Conjugate:
    """Remembers the last slope and direction of one level."""

    def __init__(self) -> None:
        self.slope: Params | None = None
        self.heading: Params = np.zeros(0)

    def __call__(self, slope: Params) -> Params:
        """The direction of search."""
        self.heading = slope if self.slope is None else slope + self.heading * self._share(slope, self.slope)
        self.slope = slope
        return self.heading

    def _share(self, slope: Params, before: Params) -> float:
        norm = dot(before, before)
        share = dot(slope - before, slope) / norm if norm > np.finfo(np.float64).eps else 0.0
        return share if 0.0 <= share <= _STEEPEST else 0.0
