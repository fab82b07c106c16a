"""Rotations in space: Euler angles, versors, and the rotation nearest to a matrix.

A versor is a unit quaternion told by its vector part alone, half the rotation's angle as a sine along its
axis; the scalar part is the positive root. Products run in ITK's order, so that matrices have its bits.
"""

from typing import Literal

import numpy as np

from regframe.types import Matrix, Params, Volume

Order = Literal["zxy", "zyx"]

_MARGIN = 1e-10
"""ITK's: how near to half a turn a versor may come."""


def euler(angles_rad: Params, order: Order) -> Matrix:
    """The rotation by angles about x, y and z: ``Rz Rx Ry``, or ``Rz Ry Rx`` in the order "zyx"."""
    first, second, third = (_about(axis, angles_rad[axis])[0] for axis in _axes(order))
    return _product(_product(first, second), third)


def euler_slopes(angles_rad: Params, order: Order) -> Volume:
    """Derivatives of `euler` by each angle, (3, 3, 3)."""
    slopes = np.empty((3, 3, 3))
    for turned in range(3):
        first, second, third = (_about(axis, angles_rad[axis])[int(axis == turned)] for axis in _axes(order))
        slopes[turned] = _product(_product(first, second), third)
    return slopes


def euler_angles(rotation: Matrix, order: Order) -> Params:
    """Angles about x, y and z; where two axes fall together, the angle about z is 0."""
    r = rotation
    if order == "zxy":
        cosine = np.hypot(r[2, 0], r[2, 2])
        x = np.arctan2(r[2, 1], cosine)
        if cosine < _MARGIN:
            return np.array([x, np.arctan2(r[0, 2], r[0, 0]), 0.0])
        return np.array([x, np.arctan2(-r[2, 0], r[2, 2]), np.arctan2(-r[0, 1], r[1, 1])])
    cosine = np.hypot(r[0, 0], r[1, 0])
    y = np.arctan2(-r[2, 0], cosine)
    if cosine < _MARGIN:
        return np.array([np.arctan2(-r[1, 2], r[1, 1]), y, 0.0])
    return np.array([np.arctan2(r[2, 1], r[2, 2]), y, np.arctan2(r[1, 0], r[0, 0])])


def clipped(versor: Params) -> Params:
    """The versor itself, or one just under half a turn where it is too long, as ITK clips it."""
    return np.array(_quaternion(versor)[:3])


def versor_matrix(versor: Params) -> Matrix:
    """The rotation of a versor (3,); one too long counts as just under half a turn."""
    x, y, z, w = _quaternion(versor)
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def versor_slopes(versor: Params) -> Volume:
    """Derivatives of `versor_matrix` by the three components, (3, 3, 3), the scalar part moving along."""
    x, y, z, w = _quaternion(versor)
    by_x = np.array([[0.0, y, z], [y, -2.0 * x, -w], [z, w, -2.0 * x]])
    by_y = np.array([[-2.0 * y, x, w], [x, 0.0, z], [-w, z, -2.0 * y]])
    by_z = np.array([[-2.0 * z, -w, x], [w, -2.0 * z, y], [x, y, 0.0]])
    by_w = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    along = np.multiply.outer(np.array([x, y, z]) / w, by_w)
    return np.asarray(2.0 * (np.stack([by_x, by_y, by_z]) - along))


def versor_of(rotation: Matrix) -> Params:
    """The versor of a rotation, (3,)."""
    r, trace = rotation, float(np.trace(rotation))
    squares = np.array([trace, *(2.0 * np.diag(r) - trace)])
    # Four times the products of the quaternion's parts, w first; the row of the largest is the safest.
    mixed = np.array(
        [
            [1.0 + squares[0], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], 1.0 + squares[1], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]],
            [r[0, 2] - r[2, 0], r[0, 1] + r[1, 0], 1.0 + squares[2], r[1, 2] + r[2, 1]],
            [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], 1.0 + squares[3]],
        ]
    )
    row = mixed[int(np.argmax(squares))]
    whole = row / np.linalg.norm(row)
    return np.asarray(-whole[1:] if whole[0] < 0.0 else whole[1:])


def nearest_rotation(matrix: Matrix) -> tuple[Matrix, float]:
    """The rotation nearest to a matrix in the least-squares sense, and the factor that brings it nearest.

    S. Umeyama, "Least-squares estimation of transformation parameters between two point patterns", IEEE
    Trans. Pattern Analysis and Machine Intelligence 13(4), 1991.
    """
    left, sizes, right = np.linalg.svd(matrix)
    signs = np.ones(len(matrix))
    signs[-1] = np.sign(np.linalg.det(left) * np.linalg.det(right))
    return np.asarray((left * signs) @ right), float((sizes * signs).mean())


def turned(params: Params, step: Params) -> Params:
    """Parameters whose first three are a versor, after a step: rotations compose, all others add.

    ITK's rule for its transforms with a versor and a translation. The step's first three are an axis
    times an angle in radians. A versor holds half angles, so near the identity a step moves it by half
    of what addition would.
    """
    moved = params + step
    x, y, z, w = _quaternion(params[:3])
    angle_rad = float(np.sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]))
    if angle_rad == 0.0:
        moved[:3] = x, y, z
        return moved
    a, b, c = step[:3] * (np.sin(angle_rad / 2.0) / angle_rad)
    d = np.cos(angle_rad / 2.0)
    moved[:3] = (
        w * a - z * b + y * c + x * d,
        z * a + w * b - x * c + y * d,
        -y * a + x * b + w * c + z * d,
    )
    if -x * a - y * b - z * c + w * d < 0.0:
        # Beyond half a turn the same rotation has the opposite versor.
        moved[:3] = -moved[:3]
    return moved


def _quaternion(versor: Params) -> tuple[float, float, float, float]:
    """Vector part, clipped as ITK does, and scalar part."""
    x, y, z = map(float, versor)
    length = float(np.sqrt(x * x + y * y + z * z))
    if length >= 1.0 - _MARGIN:
        longer = length + _MARGIN * length
        x, y, z = x / longer, y / longer, z / longer
        length = float(np.sqrt(x * x + y * y + z * z))
    return x, y, z, float(np.sqrt(1.0 - length * length))


def _axes(order: Order) -> tuple[int, int, int]:
    return (2, 0, 1) if order == "zxy" else (2, 1, 0)


def _about(axis: int, angle_rad: float) -> tuple[Matrix, Matrix]:
    """The rotation about one axis, and its derivative."""
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    rotation, slope = np.zeros((3, 3)), np.zeros((3, 3))
    rotation[axis, axis] = 1.0
    plane = np.ix_((first, second), (first, second))
    rotation[plane] = [[cos, -sin], [sin, cos]]
    slope[plane] = [[-sin, -cos], [cos, -sin]]
    return rotation, slope


def _product(left: Matrix, right: Matrix) -> Matrix:
    """The matrix product, summed in order; a library's may fuse and reorder."""
    total: Matrix = left[:, :1] * right[:1]
    for inner in range(1, len(right)):
        total = total + left[:, inner : inner + 1] * right[inner : inner + 1]
    return total
