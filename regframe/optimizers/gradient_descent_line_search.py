"""Steepest descent with a golden section search along each slope."""

from typing import final

from regframe.optimizers.line_search import Direction, LineSearchDescent
from regframe.types import Params


@final
class GradientDescentLineSearch(LineSearchDescent):
    """Walk straight downhill, each time as far as a golden section search says.

    J. Kiefer, "Sequential minimax search for a maximum", Proc. American Mathematical Society 4(3), 1953,
    along the steepest descent; `itk::GradientDescentLineSearchOptimizerv4`, whose path it walks. An
    iteration costs one slope and about 14 values.

    Four departures from ITK: `keep` says which position is reported; places of the search where nothing
    overlaps are passed by, also where ITK's Mattes metric would abort the run; the learning rate is
    estimated wherever that is asked for, where ITK does so only beside estimated scales; and where it is
    not, each level begins with `learning_rate`, where ITK goes on with the last rate found.
    """

    def direction(self) -> Direction:
        """The slope itself."""
        return _straight


def _straight(slope: Params) -> Params:
    return slope
