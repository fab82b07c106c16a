"""Gaussian smoothing and derivatives by recursive filters, with ITK's bits.

R. Deriche, "Recursively implementing the Gaussian and its derivatives", INRIA report 1893, 1993, with the
fit of `itk::RecursiveGaussianImageFilter`: fourth order, causal plus anticausal, edges extended. Lines are
filtered in float64; as in ITK the image is rounded to float32 after each axis, also for float64 images.
"""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from regframe.errors import GeometryError
from regframe.image import Pixels
from regframe.kernels.jit import kernel
from regframe.kernels.sharing import share
from regframe.types import Matrix, Values, Volume

Order = Literal[0, 1, 2]

U = np.uint64
LANES = 8
"""Lines filtered side by side: one processor instruction serves several."""

SHORTEST = 4
"""Fewest pixels along an axis that the fourth-order filter can start on."""

_DECAYS = (-1.3932, -1.3732)
_WAVES = (0.6681, 2.0787)
# per order: cosine and sine amplitude of the first wave, then of the second
_AMPLITUDES = (
    (1.3530, 1.8151, -0.3531, 0.0902),
    (-0.6724, -3.4327, 0.6724, 0.6100),
    (-1.3563, 5.2318, 0.3446, -2.2355),
)


def smooth(values: Pixels, sigmas: Sequence[float]) -> Pixels:
    """Smooth by a Gaussian; axes are taken as ITK takes them: the slowest first, then x, then y.

    Parameters
    ----------
    values : (ny, nx) or (nz, ny, nx) float32 or float64
    sigmas : sequence of float, pixels, array order
        Width along each axis; 0 leaves the axis alone.

    Returns
    -------
    array of the shape and type of `values`
        Rounded to float32 after each axis.

    Raises
    ------
    GeometryError
        A smoothed axis is shorter than 4 pixels.

    Examples
    --------
    >>> edge = np.repeat([0.0, 1.0], 5)[None].repeat(8, axis=0)
    >>> smooth(edge, (0.0, 1.0))[0, 3:7].round(2)
    array([0.06, 0.3 , 0.7 , 0.94])
    """
    smoothed = np.array(values, dtype=np.float64, order="C")
    for axis in (0, *range(values.ndim - 1, 0, -1)):
        if sigmas[axis] > 0.0:
            filter_axis(smoothed, axis, coefficients(sigmas[axis], 0))
    return smoothed.astype(np.float32) if values.dtype == np.float32 else smoothed


def gradient(
    values: Pixels, sigma: float, *, spacing: Sequence[float], direction: Matrix | None = None
) -> Volume:
    """Slopes of the smoothed image times `sigma`: what ITK's metrics call the image's gradient.

    Along each axis a Gaussian derivative, "normalised across scale", then Gaussians along the others.

    Parameters
    ----------
    values : (ny, nx) or (nz, ny, nx) float32 or float64
    sigma : float, mm
        Width of the Gaussian; ITK's metrics take the largest spacing.
    spacing : sequence of float, mm, x first
    direction : (dim, dim), optional
        Columns are the axis directions; without it the image's axes are the physical ones.

    Returns
    -------
    (dim, *shape) float64
        Component d, x first, along the physical axis d; before `direction` is applied, components are
        rounded to float32.

    Raises
    ------
    GeometryError
        An axis is shorter than 4 pixels.
    """
    dim = values.ndim
    slopes = np.empty((dim, *values.shape))
    for along in range(dim):
        slopes[along] = values
        for axis in sorted(range(dim), key=lambda axis: axis != along):
            wide = sigma / spacing[axis]
            line = coefficients(wide, 1, sigma) if axis == along else coefficients(wide, 0)
            filter_axis(slopes[along], dim - 1 - axis, line)
        slopes[along] = (slopes[along] / spacing[along]).astype(np.float32)
    if direction is None:
        return slopes
    turned = np.zeros_like(slopes)
    # In this order, column by column: a matrix product may fuse or reorder, and change the last bit.
    for row, column in np.ndindex(dim, dim):
        turned[row] += direction[row, column] * slopes[column]
    return turned


def coefficients(sigma: float, order: Order, gain: float = 1.0) -> Matrix:
    """Weights of the recursive filter.

    Parameters
    ----------
    sigma : float, pixels
    order : 0, 1 or 2
        Which derivative of the Gaussian.
    gain : float
        Factor on the result.

    Returns
    -------
    (5, 4) float64
        Feedback; causal weights of samples 0 to 3 behind, and of the edge before them; anticausal weights
        of samples 1 to 4 ahead, and of the edge after them.
    """
    feedback = _feedback(sigma)
    forward = _forward(sigma, order, feedback, gain)
    mirrored = np.append(forward[1:], 0.0) - feedback * forward[0]
    backward = -mirrored if order == 1 else mirrored
    total = _moments(np.array([1.0, *feedback]))[0]
    before = feedback * _moments(forward)[0] / total
    after = feedback * _moments(backward)[0] / total
    return np.stack([feedback, forward, before, backward, after])


def filter_axis(volume: Volume, axis: int, weights: Matrix) -> None:
    """Filter every line along an axis, in place, and round to float32.

    Parameters
    ----------
    volume : (ny, nx) or (nz, ny, nx) float64, C-contiguous
    axis : int, array order
    weights : (5, 4) float64
        From `coefficients`.

    Raises
    ------
    GeometryError
        The axis is shorter than 4 pixels.
    """
    length = volume.shape[axis]
    if length < SHORTEST:
        message = (
            f"Smoothing needs at least {SHORTEST} pixels along each smoothed axis. "
            f"Got {length} along axis {axis} of an image of shape {volume.shape}. "
            "Set the level's smoothing to 0, or register a larger image."
        )
        raise GeometryError(message)
    inner = math.prod(volume.shape[axis + 1 :])
    blocks = -(-volume.size // length // LANES)
    share(_filter_lines, blocks, volume.reshape(-1), length, inner, weights)


def _waves(sigma: float) -> list[tuple[float, float, float]]:
    """Decay, cosine and sine of both damped waves over one pixel."""
    pairs = zip(_DECAYS, _WAVES, strict=True)
    return [(math.exp(d / sigma), math.cos(w / sigma), math.sin(w / sigma)) for d, w in pairs]


def _moments(weights: Values) -> tuple[float, float, float]:
    """Sums of the weights times 1, k and k squared, added in order."""
    parts: list[float] = []
    for power in range(3):
        total = 0.0
        for k, weight in enumerate(weights):
            total += float(k**power * weight)
        parts.append(total)
    return parts[0], parts[1], parts[2]


def _feedback(sigma: float) -> Values:
    (e1, c1, _), (e2, c2, _) = _waves(sigma)
    return np.array(
        [
            -2.0 * (e2 * c2 + e1 * c1),
            4.0 * c2 * c1 * e1 * e2 + (e1 * e1 + e2 * e2),
            -2.0 * c1 * e1 * e2 * e2 + -2.0 * c2 * e2 * e1 * e1,
            e1 * e1 * e2 * e2,
        ]
    )


def _response(sigma: float, order: Order) -> Values:
    """Causal weights before they are normalised."""
    (e1, c1, s1), (e2, c2, s2) = _waves(sigma)
    a1, b1, a2, b2 = _AMPLITUDES[order]
    mixed = (a1 + a2) * c2 * c1 - (b1 * c2 * s1 + b2 * c1 * s2)
    return np.array(
        [
            a1 + a2,
            e2 * (b2 * s2 - (a2 + 2.0 * a1) * c2) + e1 * (b1 * s1 - (a1 + 2.0 * a2) * c1),
            mixed * (2.0 * e1 * e2) + (a2 * e1 * e1 + a1 * e2 * e2),
            e2 * e1 * e1 * (b2 * s2 - a2 * c2) + e1 * e2 * e2 * (b1 * s1 - a1 * c1),
        ]
    )


def _forward(sigma: float, order: Order, feedback: Values, gain: float) -> Values:
    """Causal weights, so normalised that a polynomial of degree `order` has its true derivative."""
    sd, dd, ed = _moments(np.array([1.0, *feedback]))
    forward = _response(sigma, order)
    if order == 2:
        plain = _response(sigma, 0)
        sn, sn0 = _moments(forward)[0], _moments(plain)[0]
        forward = forward + -(2.0 * sn - sd * forward[0]) / (2.0 * sn0 - sd * plain[0]) * plain
    sn, dn, en = _moments(forward)
    if order == 0:
        scale = 2.0 * sn / sd - forward[0]
    elif order == 1:
        scale = 2.0 * (sn * dd - dn * sd) / (sd * sd)
    else:
        scale = (en * sd * sd - ed * sn * sd - 2.0 * dn * dd * sd + 2.0 * dd * dd * sn) / (sd * sd * sd)
    return np.asarray(forward * (gain / scale), dtype=np.float64)


@kernel
def _filter_lines(first: int, last: int, flat: Values, n: int, inner: int, weights: Matrix) -> None:
    """Filter blocks of `LANES` lines; `inner` is the distance between the pixels of a line."""
    lines = flat.size // n
    line, mirrored = np.empty((n + 3) * LANES), np.empty((n + 4) * LANES)
    causal, anticausal = np.empty(n * LANES), np.empty(n * LANES)
    starts = np.empty(LANES, np.int64)
    for block in range(first, last):
        for lane in range(LANES):
            # a last block that is not full repeats its last line
            number = min(block * LANES + lane, lines - 1)
            starts[lane] = number // inner * inner * n + number % inner
        for i in range(n):
            ahead, behind = (i + 3) * LANES, (n + 3 - i) * LANES
            for lane in range(LANES):
                pixel = flat[U(starts[lane] + i * inner)]
                line[U(ahead + lane)] = pixel
                mirrored[U(behind + lane)] = pixel
        for i in range(3 * LANES):
            line[i] = line[3 * LANES + i % LANES]
        for i in range(4 * LANES):
            mirrored[i] = mirrored[4 * LANES + i % LANES]
        _recurse(line, weights[1], weights[2], weights[0], causal)
        _recurse(mirrored, weights[3], weights[4], weights[0], anticausal)
        for i in range(n):
            ahead, behind = i * LANES, (n - 1 - i) * LANES
            for lane in range(LANES):
                both = causal[U(ahead + lane)] + anticausal[U(behind + lane)]
                flat[U(starts[lane] + i * inner)] = np.float32(both)


@kernel
def _recurse(samples: Values, forward: Values, edge: Values, feedback: Values, out: Values) -> None:
    """Run the recursion along `LANES` lines; `samples` begins with the edge, repeated.

    Output row j takes samples of rows j + 3 down to j, and subtracts the feedback of the four rows before;
    before the line there is the steady state of the edge.
    """
    for j in range(4):
        for lane in range(LANES):
            total, echo = 0.0, 0.0
            for k in range(4):
                total += samples[(j + 3 - k) * LANES + lane] * forward[k]
                if k < j:
                    echo += out[(j - 1 - k) * LANES + lane] * feedback[k]
                else:
                    echo += samples[lane] * edge[k]
            out[j * LANES + lane] = total - echo
    f0, f1, f2, f3 = forward[0], forward[1], forward[2], forward[3]
    b1, b2, b3, b4 = feedback[0], feedback[1], feedback[2], feedback[3]
    for at in range(U(4 * LANES), U(out.size)):
        near, far = at + U(2 * LANES), at + U(LANES)
        total = samples[at + U(3 * LANES)] * f0 + samples[near] * f1 + samples[far] * f2 + samples[at] * f3
        echo = out[at - U(LANES)] * b1 + out[at - U(2 * LANES)] * b2 + out[at - U(3 * LANES)] * b3
        out[at] = total - (echo + out[at - U(4 * LANES)] * b4)
