"""The discrete Gaussian, with the approximations that ITK makes it of."""

import numpy as np

from regframe.types import Values

DIGITS = 10.0  # of the Bessel functions of order 2 and more
# Their approximations at orders 0 and 1, below the border and above it.
BORDER = 3.75
SMALL = (
    (1.0, 3.5156229, 3.0899424, 1.2067492, 0.2659732, 0.360768e-1, 0.45813e-2),
    (0.5, 0.87890594, 0.51498869, 0.15084934, 0.2658733e-1, 0.301532e-2, 0.32411e-3),
)
LARGE = (
    (
        *(0.39894228, 0.1328592e-1, 0.225319e-2, -0.157565e-2, 0.916281e-2),
        *(-0.2057706e-1, 0.2635537e-1, -0.1647633e-1, 0.392377e-2),
    ),
    (
        *(0.39894228, -0.3988024e-1, -0.362018e-2, 0.163801e-2, -0.1031555e-1),
        *(0.2282967e-1, -0.2895312e-1, 0.1787654e-1, -0.420059e-2),
    ),
)


def window(variance: float, missing: float, longest: int) -> Values:
    """The discrete Gaussian exp(-t) I_k(t) of variance t, from its centre to one side; its mass is 1.

    Lindeberg, "Scale-space for discrete signals", IEEE Transactions on Pattern Analysis and Machine
    Intelligence 12(3), 1990, cut off where ITK's GaussianOperator does.

    Parameters
    ----------
    missing : float
        Share of the mass that may be left off.
    longest : int
        Most taps on one side.
    """
    if not variance:
        return np.ones(1)
    taps = [np.exp(-variance) * bessel(order, variance) for order in (0, 1)]
    mass = taps[0] + 2.0 * taps[1]
    while mass < 1.0 - missing and len(taps) <= longest:
        taps.append(np.exp(-variance) * bessel(len(taps), variance))
        mass += 2.0 * taps[-1]
    return np.asarray(np.array(taps) / mass)


def bessel(order: int, at: float) -> float:
    """Modified Bessel function of the first kind, as ITK approximates it, for `at` > 0.

    Abramowitz and Stegun, "Handbook of mathematical functions", 1964, 9.8.1 to 9.8.4; downward
    recurrence from order 2 on (9.6.26). Good to 2e-7; exact ones would move the metric by 1e-9.
    """
    if order < len(SMALL):
        return _polynomial(order, at)
    total, higher, this = 0.0, 0.0, 1.0
    for k in range(2 * (order + int(DIGITS * np.sqrt(order))), 0, -1):
        higher, this = this, higher + k * (2.0 / at) * this
        if abs(this) > 1e10:
            total, higher, this = total * 1e-10, higher * 1e-10, this * 1e-10
        if k == order:
            total = higher
    return total * _polynomial(0, at) / this


def _polynomial(order: int, at: float) -> float:
    if at < BORDER:
        return at**order * _horner(SMALL[order], (at / BORDER) ** 2)
    return float(np.exp(at) / np.sqrt(at)) * _horner(LARGE[order], BORDER / at)


def _horner(factors: tuple[float, ...], at: float) -> float:
    total = 0.0
    for factor in reversed(factors):
        total = factor + at * total
    return total
