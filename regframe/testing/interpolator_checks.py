"""What every interpolator must hold, in 2-D and 3-D."""

from collections.abc import Iterator

import numpy as np

from regframe.geometry import AffineMap
from regframe.interpolators.base import Interpolator, Samples
from regframe.testing.claims import NotApplicable, require, require_close, unchanged
from regframe.types import Indices, Volume

SHAPES = ((15, 18), (7, 8, 9))
CONTRAST = 100.0  # grey levels of the tried images; tolerances are shares of it
ROUNDING = 1e-9 * CONTRAST


def example_volumes() -> Iterator[Volume]:
    """A rough plane and a rough volume, values 0 to 100.

    Examples
    --------
    >>> [volume.shape for volume in example_volumes()]
    [(15, 18), (7, 8, 9)]
    """
    for shape in SHAPES:
        yield CONTRAST * np.random.default_rng((11, len(shape))).random(shape)


def between(shape: tuple[int, ...], count: int = 60, *, rim: float = 1.0) -> Indices:
    """Indices at least `rim` inside a grid and a tenth away from pixel centres and pixel edges.

    Pieces of an interpolation meet at centres or edges, where it may have a kink or a jump.

    Examples
    --------
    >>> between((5, 5)).shape
    (60, 2)
    """
    rng = np.random.default_rng(12)
    limits = np.array(shape)
    whole = rng.integers(np.ceil(rim), np.maximum(limits - 1 - rim, np.ceil(rim) + 1), (count, len(shape)))
    return np.asarray(whole + rng.choice([0.0, 0.5], whole.shape) + rng.uniform(0.1, 0.4, whole.shape))


def check_exact_at_samples(interpolator: Interpolator) -> None:
    """At a pixel's centre the value is the pixel's."""
    _applies(interpolator.exact, "exact")
    for volume in example_volumes():
        got = interpolator.sample(interpolator.prepare(volume), Samples(volume.shape).all_indices())
        require_close(
            got.reshape(volume.shape),
            volume,
            within=ROUNDING,
            fault=f"{volume.ndim}-D: the value at a pixel's centre (whole indices) is not its own.",
        )


def check_keeps_a_constant(interpolator: Interpolator) -> None:
    """A constant image is constant everywhere inside, the outer half pixel too."""
    _applies(interpolator.keeps_constants, "keeps_constants")
    for volume in example_volumes():
        flat = np.full(volume.shape, 42.0)
        limits = np.array(volume.shape) - 1.0
        indices = np.random.default_rng(13).uniform(-0.499, limits + 0.499, (200, volume.ndim))
        got = interpolator.sample(interpolator.prepare(flat), indices)
        require_close(
            got,
            np.full(len(indices), 42.0),
            within=ROUNDING,
            fault=f"{volume.ndim}-D: a constant image is not constant.",
        )


def check_is_linear_in_the_image(interpolator: Interpolator) -> None:
    """A sum of images gives the sum of their values."""
    _applies(interpolator.additive, "additive")
    for volume in example_volumes():
        other = volume[::-1].copy()
        indices = between(volume.shape)
        one, two, both = (
            interpolator.sample(interpolator.prepare(image), indices)
            for image in (volume, other, volume + 2 * other)
        )
        require_close(
            both,
            one + 2 * two,
            within=10 * ROUNDING,
            fault=f"{volume.ndim}-D: values do not add as their images do.",
        )


def check_resample_equals_its_default(interpolator: Interpolator) -> None:
    """The fused `resample` gives what map, inside test and `sample` give one after the other."""
    for volume in example_volumes():
        coefficients = interpolator.prepare(volume)
        for samples, index_map in _tasks(volume.shape):
            got = interpolator.resample(coefficients, samples, index_map)
            wanted = Interpolator.resample(interpolator, coefficients, samples, index_map)
            what = f"{volume.ndim}-D, {'the whole grid' if samples.indices is None else 'sparse samples'}"
            require_close(
                got[1], wanted[1], within=0.0, fault=f"{what}: weights of `resample` are not its default's."
            )
            require_close(
                got[0],
                wanted[0],
                within=ROUNDING,
                fault=f"{what}: values of `resample` are not its default's.",
            )


def check_pull_back_equals_its_default(interpolator: Interpolator) -> None:
    """The fused `pull_back` gives what `gradient` and the chain rule give."""
    for volume in example_volumes():
        coefficients = interpolator.prepare(volume)
        for samples, index_map in _tasks(volume.shape):
            if index_map is None:
                continue
            inside = interpolator.resample(coefficients, samples, index_map)[1]
            forces = inside * np.random.default_rng(14).standard_normal(len(inside))
            got = interpolator.pull_back(coefficients, samples, index_map, forces)
            wanted = Interpolator.pull_back(interpolator, coefficients, samples, index_map, forces)
            scale = max(float(np.abs(wanted).max()), CONTRAST)
            what = f"{volume.ndim}-D, {'the whole grid' if samples.indices is None else 'sparse samples'}"
            require_close(
                got / scale, wanted / scale, within=1e-9, fault=f"{what}: `pull_back` is not its default's."
            )


def check_gradient_is_the_slope_of_sample(interpolator: Interpolator) -> None:
    """`gradient` is the derivative of `sample` itself, away from kinks."""
    for volume in example_volumes():
        coefficients, indices = interpolator.prepare(volume), between(volume.shape)
        got, step = interpolator.gradient(coefficients, indices), 1e-4
        require(
            got.shape == indices.shape,
            f"{volume.ndim}-D: `gradient` must have one slope an axis, {indices.shape}. Got {got.shape}.",
        )
        for axis in range(volume.ndim):
            move = np.zeros(volume.ndim)
            move[axis] = step
            ahead, behind = (interpolator.sample(coefficients, indices + side * move) for side in (1, -1))
            require_close(
                got[:, axis],
                (ahead - behind) / (2 * step),
                within=1e-5 * CONTRAST,
                fault=f"{volume.ndim}-D: `gradient` along array axis {axis} is not the slope of `sample`.",
            )


def check_knows_its_borders(interpolator: Interpolator) -> None:
    """Inside is -0.5 <= index < n - 0.5; outside, weight and value are 0."""
    for volume in example_volumes():
        coefficients = interpolator.prepare(volume)
        for axis, length in enumerate(volume.shape):
            places = np.array([-0.5 - 1e-9, -0.5, length - 0.5 - 1e-9, length - 0.5, -7.0, length + 7.0])
            indices = np.full((len(places), volume.ndim), 2.3)
            indices[:, axis] = places
            values, weights = interpolator.resample(coefficients, Samples(volume.shape, indices), None)
            where = f"{volume.ndim}-D, axis {axis}, indices {places.tolist()}"
            require_close(
                weights, np.array([0, 1, 1, 0, 0, 0]), within=0.0, fault=f"{where}: wrong inside weights."
            )
            require(
                not values[weights == 0].any(), f"{where}: values outside must be 0. Got {values.tolist()}."
            )
            require(
                bool(np.isfinite(values).all()), f"{where}: values must be finite. Got {values.tolist()}."
            )


def check_survives_thin_images(interpolator: Interpolator) -> None:
    """An axis of one or three pixels makes an image too."""
    for shape in ((1, 9), (9, 1), (3, 3), (1, 5, 6)):
        volume = CONTRAST * np.random.default_rng(15).random(shape)
        values, weights = interpolator.resample(interpolator.prepare(volume), Samples(shape), None)
        require(bool(np.isfinite(values).all()), f"An image of {shape}: values must be finite.")
        if interpolator.exact:
            require_close(
                values.reshape(shape), volume, within=ROUNDING, fault=f"An image of {shape} changes in place."
            )
        require(bool(weights.all()), f"An image of {shape}: its own pixels are outside.")


def check_leaves_its_input_alone(interpolator: Interpolator) -> None:
    """No method writes into the image, the coefficients or the indices."""
    for volume in example_volumes():
        indices = between(volume.shape)
        image = volume.copy()
        coefficients = interpolator.prepare(image)
        require(
            unchanged(volume, image),
            f"{volume.ndim}-D: `prepare` writes into the image. Copy before changing.",
        )
        kept, places = coefficients.copy(), indices.copy()
        interpolator.sample(coefficients, indices)
        interpolator.gradient(coefficients, indices)
        for samples, index_map in _tasks(volume.shape):
            interpolator.resample(coefficients, samples, index_map)
        require(unchanged(kept, coefficients), f"{volume.ndim}-D: coefficients are written into.")
        require(unchanged(places, indices), f"{volume.ndim}-D: indices are written into.")


CHECKS = (
    check_exact_at_samples,
    check_keeps_a_constant,
    check_is_linear_in_the_image,
    check_resample_equals_its_default,
    check_pull_back_equals_its_default,
    check_gradient_is_the_slope_of_sample,
    check_knows_its_borders,
    check_survives_thin_images,
    check_leaves_its_input_alone,
)


def _applies(claimed: bool, name: str) -> None:
    if not claimed:
        message = f"the interpolator says `{name} = False`"
        raise NotApplicable(message)


def _tasks(shape: tuple[int, ...]) -> Iterator[tuple[Samples, AffineMap | None]]:
    """Whole and sparse samples, unmoved, turned and shrunk, and partly outside."""
    dim = len(shape)
    rng = np.random.default_rng(16)
    turned = np.eye(dim)
    turned[-2:, -2:] = 0.9 * np.array([[np.cos(0.2), -np.sin(0.2)], [np.sin(0.2), np.cos(0.2)]])
    maps = [
        None,
        AffineMap(turned, rng.uniform(0.6, 1.2, dim)),
        AffineMap(1.2 * turned.T, rng.uniform(-2.3, -1.1, dim)),
    ]
    whole = Samples((6, 11) if dim == 2 else (4, 5, 6))
    sparse = Samples(shape, rng.uniform(0.0, 1.0, (40, dim)) * (np.array(shape) - 1.0))
    for samples in (whole, Samples(shape), sparse):
        for index_map in maps:
            yield samples, index_map
