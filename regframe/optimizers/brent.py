"""The search along one line that Powell's method is made of: ITK's bracket, then Brent's method."""

import math
from collections.abc import Callable
from typing import NamedTuple

Height = Callable[[float], float]

_GOLDEN = (1.0 + math.sqrt(5.0)) / 2.0
_SECTION = (3.0 - math.sqrt(5.0)) / 2.0
_TINY = 1e-20


class Place(NamedTuple):
    """A place on a line, and the height there."""

    at: float
    height: float


def lowest(height: Height, known: float, step: float, tolerance: float, rounds: int) -> Place:
    """The lowest place near 0 on a line, never above it.

    Parameters
    ----------
    height : callable
        Infinite where nothing overlaps.
    known : float
        The height at 0.
    step : float
        The first place tried.
    tolerance : float
        Precision of the place.
    rounds : int
        Most rounds of Brent's method, one evaluation each; the bracket before it takes what it needs.

    Examples
    --------
    >>> found = lowest(lambda x: (x - 3.0) ** 2, 9.0, 1.0, 1e-6, 100)
    >>> round(found.at, 6)
    3.0
    """
    ends, middle = bracket(height, known, step)
    return brent(height, ends, middle, tolerance, rounds)


def bracket(height: Height, known: float, step: float) -> tuple[tuple[float, float], Place]:
    """Two ends with a lower place between them; ITK leaves the first end where it is."""
    first, second = Place(0.0, known), Place(step, height(step))
    if second.height >= first.height:
        first, second = second, first
    while True:
        end = first.at + _GOLDEN * (second.at - first.at)
        beyond = Place(end, height(end))
        if not beyond.height < second.height:
            return (min(first.at, end), max(first.at, end)), second
        second = beyond


def brent(height: Height, ends: tuple[float, float], middle: Place, tolerance: float, rounds: int) -> Place:
    """The lowest place between two ends, by golden sections and parabolas (Brent, 1973)."""
    low, high = ends
    # The best, the second best and the one before it; the third begins at 0, as in ITK.
    x, w, v = middle, middle, Place(0.0, middle.height)
    for _ in range(rounds):
        half, centre = (high - low) * 0.5, (low + high) / 2.0
        near = tolerance * abs(x.at) + _TINY
        if abs(x.at - centre) <= 2.0 * near - half or half < tolerance:
            break
        step = _SECTION * ((high if x.at < centre else low) - x.at)
        if abs(x.at - w.at) >= near:
            step = _parabola((x, w, v), (low, high), step, 2.0 * near)
        if abs(step) < near:
            step = near if step > 0.0 else -near
        at = x.at + step
        tried = Place(at, height(at))
        if tried.height <= x.height:
            low, high = (low, x.at) if at < x.at else (x.at, high)
            x, w, v = tried, x, w
            continue
        low, high = (at, high) if at < x.at else (low, at)
        if tried.height <= w.height or w.at == x.at:
            w, v = tried, w
        elif tried.height <= v.height or v.at in (x.at, w.at):
            v = tried
    return x


def _parabola(
    places: tuple[Place, Place, Place], ends: tuple[float, float], golden: float, margin: float
) -> float:
    """The step to a parabola's lowest point, if it is inside and shorter than the golden one."""
    x, w, v = places
    t = (x.at - w.at) * (x.height - v.height)
    q = (x.at - v.at) * (x.height - w.height)
    p = (x.at - v.at) * q - (x.at - w.at) * t
    q = 2.0 * (q - t)
    p, q = (-p, q) if q > 0.0 else (p, -q)
    inside = q * (ends[0] - x.at + margin) < p < q * (ends[1] - x.at - margin)
    return p / q if abs(p) < abs(golden * q) and inside else golden
