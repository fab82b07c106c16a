"""Rounding of interpolated values to the precision of the image they come from."""

import numpy as np

from regframe.kernels.jit import kernel
from regframe.types import Values


@kernel
def round_single(values: Values) -> None:
    """Round (n,) values to float32 in place, as ITK does when it interpolates in float32 images."""
    # One thread: waking a second one takes as long as the work.
    for i in range(np.uint64(len(values))):
        values[i] = np.float64(np.float32(values[i]))
