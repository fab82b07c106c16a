"""The turn that ITK's initialiser gives, down to which end of an axis it takes for the front."""

import math

import numpy as np

from regframe.errors import GeometryError
from regframe.image import Image
from regframe.types import Matrix, Params

SPACE = 3


def itk_turn(fixed: tuple[Image, Matrix], moving: tuple[Image, Matrix]) -> Matrix:
    """The rotation of ITK's `CenteredVersorTransformInitializer`, of two images and their spreads.

    It multiplies its matrices of axes in the wrong order, so it lays no axis on another unless one of the
    images has its axes along x, y and z. To repeat ITK's results.

    Raises
    ------
    GeometryError
        Planes: ITK has it in space alone.
    """
    if fixed[0].dim != SPACE:
        message = (
            f'start = "itk-principal-axes" is for 3-D images. Got {fixed[0].dim}-D. Write "principal-axes".'
        )
        raise GeometryError(message)
    first, second = (_proper(eigenvectors(spread).T) for _, spread in (fixed, moving))
    return np.asarray(second @ np.linalg.inv(first))


def _proper(rows: Matrix) -> Matrix:
    rows = rows.copy()
    rows[-1] *= np.linalg.det(rows)
    return rows


def eigenvectors(symmetric: Matrix) -> Matrix:
    """Eigenvectors of a symmetric (3, 3) matrix, one a column, by rising eigenvalue, with EISPACK's signs.

    One Householder reflection from the last row makes it tridiagonal, then come QL steps with implicit
    shifts: Bowdler, Martin, Reinsch and Wilkinson, "The QR and QL algorithms for symmetric matrices",
    Numerische Mathematik 11, 1968. Any solver finds these axes; the order of these steps gives the same ends
    of them as the one that ITK uses.
    """
    basis = _reflection(symmetric[2, :2])
    straight = basis.T @ symmetric @ basis
    values, beside = np.diag(straight).copy(), np.array([straight[1, 0], straight[2, 1], 0.0])
    moved = largest = 0.0
    for first in range(SPACE):
        largest = max(largest, abs(values[first]) + abs(beside[first]))
        last = first
        while largest + abs(beside[last]) != largest:
            last += 1
        while last != first:
            moved += _step(values, beside, basis, (first, last))
            if largest + abs(beside[first]) == largest:
                break
        values[first] += moved
    return basis[:, np.argsort(values, kind="stable")]


def _reflection(row: Params) -> Matrix:
    """The reflection that leaves nothing of a row's first element, in the plane of x and y."""
    basis, size = np.eye(SPACE), float(np.abs(row).sum())
    if size > 0.0:
        across = row / size
        square = float(across @ across)
        length = -math.copysign(math.sqrt(square), across[1])
        square -= across[1] * length
        across[1] -= length
        basis[:2, :2] -= np.outer(across, across) / square
    return basis


def _step(values: Params, beside: Params, basis: Matrix, block: tuple[int, int]) -> float:
    """One QL step on the rows of a block, in place; by how much it shifts all values from the first on."""
    first, last = block
    near, ratio = beside[first], (values[first + 1] - values[first]) / (2.0 * beside[first])
    ratio += math.copysign(math.hypot(ratio, 1.0), ratio)
    shift = values[first] - near / ratio
    values[first], values[first + 1] = near / ratio, near * ratio
    values[first + 2 :] -= shift
    following, further = values[first + 1], beside[first + 1]
    at, cosine, sine = values[last], 1.0, 0.0
    cosines, sines = [1.0], [0.0]
    for i in range(last - 1, first - 1, -1):
        crossed, straight = cosine * beside[i], cosine * at
        radius = math.hypot(at, beside[i])
        beside[i + 1] = sine * radius
        cosines.append(cosine)
        sines.append(sine)
        sine, cosine = beside[i] / radius, at / radius
        at = cosine * values[i] - sine * crossed
        values[i + 1] = straight + sine * (cosine * crossed + sine * values[i])
        one, other = basis[:, i].copy(), basis[:, i + 1].copy()
        basis[:, i], basis[:, i + 1] = cosine * one - sine * other, sine * one + cosine * other
    at = -sine * sines[-1] * cosines[-2] * further * near / following
    beside[first], values[first] = sine * at, cosine * at
    return float(shift)
