"""Names for the arrays that cross module borders.

Shapes and units are part of the name: read ``n`` as samples, ``dim`` as 2 or 3, ``p`` as parameters.
"""

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]  # (n,), intensities or weights
Points = NDArray[np.float64]  # (n, dim), physical, x first
Indices = NDArray[np.float64]  # (n, dim), continuous, array order (z, y, x)
Params = NDArray[np.float64]  # (p,), in the transform's own units
Matrix = NDArray[np.float64]  # two axes, stated where used
Scores = NDArray[np.float64] | NDArray[np.float32]  # of every translation; they only rank
Volume = NDArray[np.float64]  # (ny, nx) or (nz, ny, nx), one value a grid point
Mask = NDArray[np.bool_]  # a volume of claims: True counts
Bins = NDArray[np.int64]  # (n,), histogram bin of each sample
Cells = NDArray[np.int32]  # (n,), place in a table of each sample
