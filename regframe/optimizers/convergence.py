"""When a value has stopped falling, as ITK judges it."""

import math

import numpy as np
from numpy.typing import NDArray

Singles = NDArray[np.float32]


class Window:
    """The fall of the last values of a level, as a share of the sum of all of them.

    `itk::Function::WindowConvergenceMonitoringFunction`: two linear B-splines, one falling and one rising
    over the window, are each fitted to the values, and their coefficients compared. The divisor is the sum
    of all magnitudes since the level began, so a level that runs long is stopped earlier. Weights are
    single precision as ITK's are, each operation rounded, which gives ITK's answer to the last digits; in
    double precision it would differ in the sixth.

    Parameters
    ----------
    size : int
        Number of values that are judged.

    Examples
    --------
    >>> window = Window(3)
    >>> [round(window.push(value), 3) for value in (4.0, 2.0, 1.0, 1.0)]
    [inf, inf, 0.343, 0.1]
    """

    def __init__(self, size: int) -> None:
        self.size = size
        self.total = 0.0
        self.last: list[float] = []
        self.falling, self.rising = _weights(size)

    def push(self, value: float) -> float:
        """Take one more value; positive while values fall, infinite until the window is full."""
        self.total += abs(value)
        self.last = [*self.last, value][-self.size :]
        if len(self.last) < self.size:
            return math.inf
        if self.total == 0.0:
            return 0.0
        shares = [one / self.total for one in self.last]
        return _fit(self.falling, shares) - _fit(self.rising, shares)


def _weights(size: int) -> tuple[tuple[Singles, float], tuple[Singles, float]]:
    """Each spline's factors of the values, and the sum of its squares."""
    one = np.float32(1.0)
    along = np.arange(size, dtype=np.float32) / np.float32(size - 1)
    along[-1] = one - np.float32(1e-4)
    # The rising hat is 1 - |1 - u| in single precision, which is not quite u.
    hats = (one - along, one - (one - along))
    norm = hats[0] * hats[0] + hats[1] * hats[1]
    return (_spline(hats[0], norm), _spline(hats[1], norm))


def _spline(hat: Singles, norm: Singles) -> tuple[Singles, float]:
    squares = np.cumsum(hat * hat, dtype=np.float32)
    return (hat * hat) * hat / norm, float(squares[-1])


def _fit(spline: tuple[Singles, float], shares: list[float]) -> float:
    factors, squares = spline
    return sum(float(factor) * share for factor, share in zip(factors, shares, strict=True)) / squares
