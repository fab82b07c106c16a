"""Moments of an image's intensities: its centre of mass, and the axes about which they are spread."""

from itertools import product

import numpy as np

from regframe.errors import ImageError
from regframe.image import Image
from regframe.types import Matrix, Params, Values


def mass_centre(image: Image) -> Params:
    """Intensity-weighted centre, physical; signed intensities without threshold, as in ITK.

    Raises
    ------
    ImageError
        The intensities sum to 0.
    """
    return np.asarray(image.grid.points(_index_centre(image)[None])[0])


def principal_axes(image: Image) -> Matrix:
    """Axes of the spread of intensities about their centre, one a row, the narrowest first.

    Eigenvectors of the second central moments, as in ITK's image moments; each may point either way.

    Raises
    ------
    ImageError
        The intensities sum to 0.
    """
    return np.asarray(np.linalg.eigh(spread(image))[1].T)


def spread(image: Image) -> Matrix:
    """The second central moments of an image's intensities, physical, over their sum: (dim, dim)."""
    values, centre = np.asarray(image.values, np.float64), _index_centre(image)
    total, dim = float(values.sum()), image.dim
    places = [np.arange(n) - middle for n, middle in zip(values.shape, centre, strict=True)]
    found = np.empty((dim, dim))
    for a, b in product(range(dim), repeat=2):
        found[a, b] = _moment(values, places, (a, b)) / total
    # To x first, and from index to physical offsets.
    scaled = image.grid.index_to_point.matrix
    return np.asarray(scaled @ found[::-1, ::-1] @ scaled.T)


def turn_between(fixed: Image, moving: Image) -> Matrix:
    """The rotation that lays the fixed image's principal axes on the moving image's.

    An axis has no front end, so there are two such rotations in a plane and four in space; this is the
    one of the smallest angle. ITK's `CenteredVersorTransformInitializer` takes whichever ends its eigenvector
    solver happens to give, and multiplies its two matrices of axes in the wrong order, so that it turns about
    as far the wrong way; this does not follow it, `itk_turn` does.
    """
    first, second = principal_axes(fixed), principal_axes(moving)
    # Rows are axes: `first` takes fixed points to coordinates along them, `second.T` goes back to points.
    turns = [(second.T * signs) @ first for signs in product((1.0, -1.0), repeat=fixed.dim)]
    return max((one for one in turns if np.linalg.det(one) > 0.0), key=np.trace)


def _index_centre(image: Image) -> Params:
    """The centre of mass as an index, array order."""
    values = np.asarray(image.values, np.float64)
    total = float(values.sum())
    if total == 0.0:
        message = (
            f"{image.name}: its intensities sum to 0, so it has no centre of mass. "
            'Use start = "centres", or shift the intensities with a filter.'
        )
        raise ImageError(message)
    return np.array(
        [
            float((values.sum(axis=_others(values.ndim, (a,))) * np.arange(n)).sum()) / total
            for a, n in enumerate(values.shape)
        ]
    )


def _moment(values: Values, places: list[Values], axes: tuple[int, int]) -> float:
    """The sum of intensity times the place along two axes."""
    a, b = min(axes), max(axes)
    if a == b:
        return float(values.sum(axis=_others(values.ndim, axes)) @ places[a] ** 2)
    return float(places[a] @ values.sum(axis=_others(values.ndim, axes)) @ places[b])


def _others(dim: int, axes: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(other for other in range(dim) if other not in axes)
