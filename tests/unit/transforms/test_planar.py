import numpy as np
import pytest

from naive.planar import distorted, projected, undistorted
from regframe.geometry import Frame, Grid
from regframe.transforms.homography import inverted
from regframe.transforms.lens import Lens
from regframe.transforms.projective import Projective
from regframe.transforms.projective_radial import ProjectiveRadial

FIXED, MOVING = Grid.of_shape((48, 64)), Grid.of_shape((30, 50))
FRAME = Frame.about_centre(FIXED, MOVING)


@pytest.mark.parametrize("bends", [(0.05, -0.02, -0.2, 0.03), (-0.1, 0.0, 0.03, 0.0), (0, 0, -0.2, -0.05)])
def test_the_kernel_agrees_with_its_slow_twin(bends):
    family = ProjectiveRadial(fixed_coefficients=2, moving_coefficients=2)
    params = np.array([0.7, 0.02, -0.03, 0.72, -7.0, -9.0, 0.06, -0.04, *bends])
    _, plane, moving = family.parts(params, FRAME)
    at = FIXED.points(FIXED.all_indices())[::7]
    edge = min(np.sqrt(moving.limit), 10.0)

    found = family.map(params, at, FRAME)

    for point, there in zip(at.tolist(), found, strict=True):
        straight = undistorted(point, FIXED.centre, FIXED.radius, bends[:2])
        ideal = projected(straight, plane.homogeneous())
        wanted = distorted(ideal, MOVING.centre, MOVING.radius, bends[2:], edge)
        np.testing.assert_allclose(there, wanted, atol=1e-9)


def test_a_homography_agrees_with_its_slow_twin_and_with_lenses_that_bend_nothing():
    params = np.array([0.7, 0.02, -0.03, 0.72, -7.0, -9.0, 0.06, -0.04])
    at = FIXED.points(FIXED.all_indices())[::7]
    forces = np.random.default_rng(1).normal(size=at.shape)
    family, straight = Projective(), ProjectiveRadial(fixed_coefficients=1, moving_coefficients=1)
    whole = family.as_homogeneous(params, FRAME)

    found = family.map(params, at, FRAME)
    slope = family.parameter_gradient(params, at, forces, FRAME)

    wanted = [projected(point, whole) for point in at.tolist()]
    np.testing.assert_allclose(found, wanted, atol=1e-10)
    unbent = np.concatenate([params, np.zeros(2)])
    np.testing.assert_allclose(found, straight.map(unbent, at, FRAME), atol=1e-10)
    pulled = straight.parameter_gradient(unbent, at, forces, FRAME)[:8]
    np.testing.assert_allclose(slope, pulled, rtol=1e-10, atol=1e-9)


@pytest.mark.parametrize(
    ("bends", "limit"),
    [((), np.inf), ((0.25,), 4.0), ((-0.25,), 4.0), ((0.0, 1 / 3), 1.0), ((0.0, -1.0), 1.0)],
)
def test_the_limit_is_where_the_law_stops_rising(bends, limit):
    assert Lens.of_image(FIXED, np.array(bends)).limit == pytest.approx(limit, rel=1e-6)


def test_a_matrix_is_inverted_with_its_sign():
    whole = np.array([[2.0, 0, 3], [0, 2, 4], [0.01, 0, 1]])

    np.testing.assert_allclose(inverted(whole) @ whole, np.eye(3), atol=1e-12)
