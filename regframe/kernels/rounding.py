"""Rounding of interpolated values to the precision of the image they come from."""

import numpy as np

from regframe.kernels.jit import kernel, share
from regframe.types import Values


@kernel
def _round(first: int, last: int, values: Values) -> None:
    for i in range(np.uint64(first), np.uint64(last)):
        values[i] = np.float64(np.float32(values[i]))


def round_single(values: Values) -> None:
    """Round (n,) values to float32 in place, as ITK does when it interpolates in float32 images."""
    share(_round, len(values), values)
