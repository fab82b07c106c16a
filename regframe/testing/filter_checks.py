"""What every filter must hold."""

import numpy as np

from regframe.errors import RegframeError
from regframe.filters.base import Filter
from regframe.image import Image
from regframe.testing.claims import require, unchanged
from regframe.testing.phantoms import smooth_pair

GUARD = "Guard the division by its range or deviation."


def example_images() -> list[Image]:
    """A plane and a volume, one of them in single precision and with a mask.

    Examples
    --------
    >>> [image.dim for image in example_images()]
    [2, 3]
    """
    plane = smooth_pair("mono", (32, 40)).fixed
    mask = np.zeros(plane.grid.shape, dtype=np.bool_)
    mask[4:-4, 6:-2] = True
    volume = smooth_pair("mono", (10, 12, 14)).fixed
    return [plane.with_values(plane.values.astype(np.float32)).with_mask(mask), volume]


def check_keeps_grid_and_mask(given: Filter) -> None:
    """A filter changes values; where they lie and which count stays."""
    for image in example_images():
        changed = given(image)
        require(
            changed.grid == image.grid, f"{image.dim}-D: the grid changes. Return image.with_values(...)."
        )
        require(
            changed.mask is image.mask, f"{image.dim}-D: the mask changes. Return image.with_values(...)."
        )


def check_leaves_its_input_alone(given: Filter) -> None:
    """The image that goes in is not written into."""
    for image in example_images():
        before = image.values.copy()
        given(image)
        require(
            unchanged(before, image.values), f"{image.dim}-D: the filter writes into its input. Copy first."
        )


def check_is_deterministic(given: Filter) -> None:
    """The same image gives the same bits."""
    for image in example_images():
        require(
            unchanged(given(image).values, given(image).values),
            f"{image.dim}-D: two calls give different values.",
        )


def check_gives_finite_values(given: Filter) -> None:
    """Values are finite floats; a flat image gives such too, or is refused with a reason."""
    for image in example_images():
        flat = image.with_rounded(np.full(image.grid.shape, 7.0))
        for name, each in (("an image", image), ("a constant image", flat)):
            try:
                values = given(each).values
            except RegframeError as error:
                # A filter may refuse an image in its own words. This is what an Image says of NaN.
                require("NaN" not in str(error), f"{image.dim}-D: {name} gives NaN. {GUARD}")
                continue
            bad = np.count_nonzero(~np.isfinite(values))
            require(
                values.dtype in (np.float32, np.float64) and not bad,
                f"{image.dim}-D: {name} gives {values.dtype} with {bad} NaN or infinite values. {GUARD}",
            )


CHECKS = (
    check_keeps_grid_and_mask,
    check_leaves_its_input_alone,
    check_is_deterministic,
    check_gives_finite_values,
)
