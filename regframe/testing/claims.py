"""How a conformance check speaks: it fails with an AssertionError that names the fault."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


class NotApplicable(Exception):
    """A check has nothing to judge in this component; the message says why."""


def require(claim: bool | np.bool_, fault: str) -> None:
    """Raise AssertionError with the fault unless the claim holds."""
    if not claim:
        raise AssertionError(fault)


def require_close(got: Array, wanted: Array, *, within: float, fault: str) -> None:
    """Raise AssertionError where two arrays differ by more than `within` anywhere.

    Parameters
    ----------
    fault : str
        What it means when they differ; the largest difference and its place are added.
    """
    got, wanted = np.asarray(got, dtype=np.float64), np.asarray(wanted, dtype=np.float64)
    require(got.shape == wanted.shape, f"{fault} Shapes differ: got {got.shape}, expected {wanted.shape}.")
    if not got.size:
        return
    # A NaN is a difference too, even against a NaN.
    difference = np.where(np.isfinite(got - wanted), np.abs(got - wanted), np.inf)
    worst = np.unravel_index(int(difference.argmax()), difference.shape)
    place = f" at {tuple(map(int, worst))}" if got.ndim else ""
    require(
        difference[worst] <= within,
        f"{fault} Got {got[worst]:.9g}{place}, expected {wanted[worst]:.9g} to within {within:.3g}.",
    )


def unchanged(before: Array, after: Array) -> bool:
    """Whether two arrays hold the same numbers, NaN for NaN."""
    return before.dtype == after.dtype and np.array_equal(before, after, equal_nan=before.dtype.kind == "f")
