"""Homography of the plane: what a pinhole camera sees of a plane, or of anything after a turn."""

from typing import ClassVar, final

import numpy as np

from regframe.geometry import AffineMap, Frame
from regframe.transforms.base import Inverse, Transform
from regframe.transforms.homography import Homography, inverted, largest_motions, net
from regframe.transforms.linear import translation_about
from regframe.types import Matrix, Params, Points


@final
class Projective(Transform):
    """Any homography of the plane: an affine map, and a depth that grows along x and y.

    ``y = M (x - c) / (1 + p . (x - c) / r) + c + t`` with r half the diagonal of the fixed image; see
    R. Hartley and A. Zisserman, "Multiple View Geometry in Computer Vision", 2nd edition, 2003, section 2.3.
    The first six parameters are those of `affine`, and mean the same: where the centre goes and how its
    surroundings are stretched. px and py are the change of depth from the centre to the image's rim, so all
    eight are of like effect. Points on or beyond the horizon, where the depth is 0 or less, have no image:
    they count as outside.

    ITK has no homography; results keep it in ``transform.json``, and as a displacement field in
    ``transform.tfm``.
    """

    dimensions: ClassVar[tuple[int, ...]] = (2,)

    def identity(self, frame: Frame) -> Params:
        """Identity matrix, no shift, no perspective."""
        return np.array([1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])

    def names(self, frame: Frame) -> tuple[str, ...]:
        """Matrix entries by row and column, the shift, the perspective."""
        return ("mxx", "mxy", "myx", "myy", "tx", "ty", "px", "py")

    def map(self, params: Params, points: Points, frame: Frame) -> Points:
        """Moving points of (n, 2) fixed points, physical, x first; beyond the horizon far from any image."""
        return homography(params, frame).place(points)

    def parameter_gradient(self, params: Params, points: Points, forces: Points, frame: Frame) -> Params:
        """Sum over points of ``forces . d map / d params``, (8,)."""
        return to_params_slope(homography(params, frame).pull(points, forces), frame)

    def shift(self, params: Params, frame: Frame) -> Params:
        """Largest motion per unit of each parameter, (p,); over a net, as corners need not move most."""

        def moved(at: Params, points: Points) -> Points:
            return self.map(at, points, frame)

        return largest_motions(moved, params, net(frame.grid), frame.moving)

    def as_homogeneous(self, params: Params, frame: Frame) -> Matrix:
        """The (3, 3) matrix."""
        return homography(params, frame).homogeneous()

    def from_affine(self, affine: AffineMap, frame: Frame) -> Params:
        """The affine map itself."""
        return np.concatenate(
            [affine.matrix.ravel(), translation_about(affine, frame.centre), np.zeros(frame.dim)]
        )

    def from_homogeneous(self, whole: Matrix, frame: Frame) -> Params:
        """The homography of a (3, 3) matrix."""
        return to_params(Homography.of_homogeneous(whole, frame.centre), frame)

    def inverse(self, params: Params, frame: Frame) -> Inverse:
        """The inverse matrix, about the middle of the moving image where that is known."""
        back = frame.swapped()
        return self, self.from_homogeneous(inverted(self.as_homogeneous(params, frame)), back), back


def homography(params: Params, frame: Frame) -> Homography:
    """The homography of the eight parameters."""
    return Homography(params[:4].reshape(2, 2), params[4:6], params[6:8] / frame.grid.radius, frame.centre)


def to_params(found: Homography, frame: Frame) -> Params:
    """The eight parameters of a homography about the frame's centre."""
    return np.concatenate([found.matrix.ravel(), found.translation, found.slant * frame.grid.radius])


def to_params_slope(slope: Params, frame: Frame) -> Params:
    """A slope by matrix, translation and slant as one by the eight parameters."""
    return np.concatenate([slope[:6], slope[6:] / frame.grid.radius])
