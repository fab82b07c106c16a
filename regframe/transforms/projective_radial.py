"""Homography between two lenses that bend straight lines."""

from typing import ClassVar, Self, final

import numpy as np
from pydantic import Field, model_validator

from regframe.geometry import AffineMap, Frame
from regframe.transforms.base import Inverse, Transform
from regframe.transforms.homography import Homography, inverted, largest_motions, net
from regframe.transforms.lens import Lens
from regframe.transforms.linear import translation_about
from regframe.transforms.planar import Parts, place, pull
from regframe.transforms.projective import homography, to_params, to_params_slope
from regframe.types import Matrix, Params, Points


@final
class ProjectiveRadial(Transform):
    """A homography, and radial distortion of one lens or both.

    A fixed point is freed from its lens's distortion, mapped by a homography as in `projective`, and bent
    as the moving image's lens does. Each lens follows the division model of A. Fitzgibbon, "Simultaneous
    linear estimation of multiple view geometry and lens distortion", CVPR 2001:
    ``straight = c + (seen - c) / (1 + k1 r^2 + k2 r^4)``, about the middle of its image, with r in half
    diagonals of that image. Wide thermal lenses have a k1 of about -0.1 to -0.3 (barrel distortion).

    Where both images see about the same scene, the two lenses can hardly be told apart: one coefficient
    of the wider one does most of the work. Points on or beyond the horizon, or beyond the radius up to
    which the model holds, count as outside. The inverse is exact: the lenses change places. A
    coefficient of the moving lens needs the moving image's grid; without one, as in a bare `Frame`, the
    moving image is taken to be as the fixed one. ITK has no such transform; see `projective`.
    """

    dimensions: ClassVar[tuple[int, ...]] = (2,)

    fixed_coefficients: int = Field(
        0, ge=0, le=2, description="Distortion coefficients of the fixed image's lens: 0, 1 or 2."
    )
    moving_coefficients: int = Field(
        1, ge=0, le=2, description="Distortion coefficients of the moving image's lens: 0, 1 or 2."
    )

    @model_validator(mode="after")
    def _check_lenses(self) -> Self:
        if self.fixed_coefficients + self.moving_coefficients == 0:
            message = "without coefficients this is a homography: choose the transform `projective`"
            raise ValueError(message)
        return self

    def identity(self, frame: Frame) -> Params:
        """Nothing moved, nothing bent."""
        plain = np.array([1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
        return np.concatenate([plain, np.zeros(self.fixed_coefficients + self.moving_coefficients)])

    def names(self, frame: Frame) -> tuple[str, ...]:
        """Those of `projective`, then the coefficients of the fixed and of the moving lens."""
        counts = {"fixed": self.fixed_coefficients, "moving": self.moving_coefficients}
        lenses = (f"{lens}_k{i + 1}" for lens, count in counts.items() for i in range(count))
        return ("mxx", "mxy", "myx", "myy", "tx", "ty", "px", "py", *lenses)

    def map(self, params: Params, points: Points, frame: Frame) -> Points:
        """Moving points of (n, 2) fixed points, physical, x first; those without an image far from any."""
        return place(self.parts(params, frame), points)

    def parameter_gradient(self, params: Params, points: Points, forces: Points, frame: Frame) -> Params:
        """Sum over points of ``forces . d map / d params``, (p,)."""
        whole = pull(self.parts(params, frame), points, forces)
        plane, fixed, moving = to_params_slope(whole[:8], frame), whole[8:10], whole[10:]
        return np.concatenate([plane, fixed[: self.fixed_coefficients], moving[: self.moving_coefficients]])

    def shift(self, params: Params, frame: Frame) -> Params:
        """Largest motion per unit of each parameter, (p,); over a net, as corners need not move most."""

        def moved(at: Params, points: Points) -> Points:
            return self.map(at, points, frame)

        return largest_motions(moved, params, net(frame.grid), frame.moving)

    def from_affine(self, affine: AffineMap, frame: Frame) -> Params:
        """The affine map itself, without distortion."""
        plain = np.concatenate([affine.matrix.ravel(), translation_about(affine, frame.centre), np.zeros(2)])
        return self._undistorted(plain)

    def from_homogeneous(self, whole: Matrix, frame: Frame) -> Params:
        """The homography of a (3, 3) matrix, without distortion."""
        return self._undistorted(to_params(Homography.of_homogeneous(whole, frame.centre), frame))

    def inverse(self, params: Params, frame: Frame) -> Inverse:
        """The inverse homography between the same lenses, which have changed places."""
        family = ProjectiveRadial(
            fixed_coefficients=self.moving_coefficients, moving_coefficients=self.fixed_coefficients
        )
        back, (fixed, plane, moving) = frame.swapped(), self.parts(params, frame)
        found = Homography.of_homogeneous(inverted(plane.homogeneous()), back.centre)
        return family, np.concatenate([to_params(found, back), moving.coefficients, fixed.coefficients]), back

    def parts(self, params: Params, frame: Frame) -> Parts:
        """The fixed image's lens, the homography between ideal images, and the moving image's lens."""
        middle = 8 + self.fixed_coefficients
        fixed = Lens.of_image(frame.grid, params[8:middle])
        moving = Lens.of_image(frame.moving or frame.grid, params[middle:])
        return fixed, homography(params, frame), moving

    def _undistorted(self, plain: Params) -> Params:
        return np.concatenate([plain, np.zeros(self.fixed_coefficients + self.moving_coefficients)])
