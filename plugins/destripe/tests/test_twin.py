"""The filter beside its formula, column by column, rank by rank."""

from math import exp

import numpy as np
import pytest

from regframe import Image
from regframe_destripe import Destripe

SHAPE = (14, 11)
WIDTHS = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)


def striped(seed: int = 1, shape: tuple[int, ...] = SHAPE):
    rng = np.random.default_rng(seed)
    return rng.normal(size=shape).cumsum(axis=-2) + 3.0 * rng.normal(size=shape[-1])


def slowly(plane, width: float):
    """A pixel that is the k-th of its column becomes the mean of the k-th values of the columns around."""
    height, columns = plane.shape
    evened = np.empty_like(plane)
    for column in range(columns):
        # scipy, which the filter asks, ends the Gaussian at four sigma.
        reach = int(4 * width + 0.5)
        shares = [exp(-0.5 * (away / width) ** 2) for away in range(-reach, reach + 1)]
        around = [mirrored(column + away, columns) for away in range(-reach, reach + 1)]
        ranked = [sorted(plane[:, each]) for each in range(columns)]
        order = sorted(range(height), key=lambda row, at=column: plane[row, at])
        for rank, row in enumerate(order):
            sums = sum(share * ranked[each][rank] for share, each in zip(shares, around, strict=True))
            evened[row, column] = sums / sum(shares)
    return evened


def mirrored(column: int, count: int) -> int:
    """The column that stands in for one beyond the image: the image is mirrored at its rim."""
    while not 0 <= column < count:
        column = -1 - column if column < 0 else 2 * count - 1 - column
    return column


def roughness(plane) -> float:
    return sum(abs(row[i + 1] - row[i]) for row in plane for i in range(len(row) - 1))


@pytest.mark.parametrize("width", [0.5, 2.0, 8.0])
def test_columns_are_those_of_the_slow_twin(width):
    plane = striped()

    evened = Destripe(sigma=width)(Image.of_array(plane)).values

    np.testing.assert_allclose(evened, slowly(plane, width), atol=1e-10)


def test_rows_are_the_columns_of_the_image_turned():
    plane = striped(2)

    evened = Destripe(sigma=2.0, direction="rows")(Image.of_array(np.ascontiguousarray(plane.T))).values

    np.testing.assert_allclose(evened.T, slowly(plane, 2.0), atol=1e-10)


def test_the_width_is_that_of_the_smoothest_of_ten():
    plane = striped(3)

    evened = Destripe()(Image.of_array(plane)).values

    smoothest = min((slowly(plane, width) for width in WIDTHS), key=roughness)
    np.testing.assert_allclose(evened, smoothest, atol=1e-10)


def test_a_volume_is_taken_slice_by_slice():
    volume = striped(4, (3, *SHAPE))

    evened = Destripe(sigma=1.0)(Image.of_array(volume)).values

    np.testing.assert_allclose(evened, [slowly(plane, 1.0) for plane in volume], atol=1e-10)
