"""Laws of homographies and of lenses: groups, round trips, and points that have no image."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from properties.strategies import seeds

from regframe.engine.resampling import resample
from regframe.errors import GeometryError
from regframe.geometry import Frame, Grid
from regframe.image import Image
from regframe.interpolators.linear import Linear
from regframe.kernels.planar import FAR, LOST
from regframe.transforms.homography import Homography, inverted
from regframe.transforms.projective import Projective
from regframe.transforms.projective_radial import ProjectiveRadial
from regframe.transforms.warp import Warp

FIXED, MOVING = Grid.of_shape((480, 640)), Grid.of_shape((300, 520))
FRAME = Frame.about_centre(FIXED, MOVING)
PLANE = Projective()
# Points lie within some 1e3 px of the origin and maps stretch by less than 10.
ROUNDING = 1e-7
coefficients = st.floats(-0.4, 0.2)


def drawn(seed, *, perspective=0.3):
    """Parameters of a homography that a rig of two cameras could have, and some more."""
    rng = np.random.default_rng(seed)
    matrix = np.eye(2) * rng.uniform(0.5, 2.0) + rng.uniform(-0.2, 0.2, (2, 2))
    return np.concatenate(
        [matrix.ravel(), rng.uniform(-150, 150, 2), rng.uniform(-perspective, perspective, 2)]
    )


def points(seed, grid=FIXED):
    return grid.points(np.random.default_rng(seed).uniform(0, 1, (40, 2)) * (np.array(grid.shape) - 1))


def member(whole):
    """The member of the family with a matrix; examples whose centre meets the horizon are passed by."""
    try:
        return Warp(PLANE, PLANE.from_homogeneous(whole, FRAME), FRAME)
    except GeometryError:
        assume(False)


@given(seeds)
def test_the_composition_of_homographies_is_one(seed):
    first, second = (Warp(PLANE, drawn(seed + i), FRAME) for i in (0, 1))
    at = points(seed)
    both = second @ first
    wanted = both(at)
    seen = np.abs(wanted).max(axis=1) < 1e4

    found = member(both.as_homogeneous())(at)

    np.testing.assert_allclose(found[seen], wanted[seen], rtol=0, atol=1e-5)


@given(seeds)
def test_composition_is_associative(seed):
    one, two, three = (Warp(PLANE, drawn(seed + i, perspective=0.1), FRAME) for i in range(3))
    at = points(seed)

    left, right = member(((three @ two) @ one).as_homogeneous()), three @ (two @ one)
    wanted = right(at)
    seen = np.abs(wanted).max(axis=1) < 1e4

    np.testing.assert_allclose(left(at)[seen], wanted[seen], rtol=0, atol=1e-5)


@given(seeds)
def test_the_inverse_undoes_a_homography(seed):
    warp = Warp(PLANE, drawn(seed), FRAME)
    at = points(seed)

    try:
        back = warp.inverse()
    except GeometryError:
        assume(False)
    there = warp(at)
    seen = np.abs(there).max(axis=1) < 1e4

    np.testing.assert_allclose(back(there)[seen], at[seen], rtol=0, atol=1e-5)
    np.testing.assert_allclose(back.inverse().params, warp.params, rtol=0, atol=1e-9)


@given(seeds)
def test_parameters_and_matrix_say_the_same(seed):
    params = drawn(seed)
    whole = PLANE.as_homogeneous(params, FRAME)

    np.testing.assert_allclose(PLANE.from_homogeneous(whole, FRAME), params, rtol=0, atol=1e-10)
    np.testing.assert_allclose(PLANE.from_homogeneous(7.5 * whole, FRAME), params, rtol=0, atol=1e-10)


def lenses(first, second, count):
    """Warps that undo, and that make, the distortion of one lens."""
    bends = np.array([first, second])[:count]
    frame = Frame.about_centre(FIXED, FIXED)
    plain = [1.0, 0, 0, 1.0, 0, 0, 0, 0]
    free = ProjectiveRadial(fixed_coefficients=count, moving_coefficients=0)
    bent = ProjectiveRadial(fixed_coefficients=0, moving_coefficients=count)
    return [Warp(family, np.array([*plain, *bends]), frame) for family in (free, bent)]


@given(coefficients, st.floats(-0.1, 0.1), st.integers(1, 2), seeds)
def test_distortion_undoes_undistortion(first, second, count, seed):
    free, bent = lenses(first, second, count)
    at = points(seed)
    straight = free(at)
    seen = np.abs(straight).max(axis=1) < LOST

    np.testing.assert_allclose(bent(straight)[seen], at[seen], rtol=0, atol=1e-6)


@given(coefficients, st.floats(-0.1, 0.1), st.integers(1, 2), seeds)
def test_undistortion_undoes_distortion(first, second, count, seed):
    free, bent = lenses(first, second, count)
    at = points(seed)
    curved = bent(at)
    seen = np.abs(curved).max(axis=1) < LOST

    np.testing.assert_allclose(free(curved)[seen], at[seen], rtol=0, atol=1e-6)


@given(st.lists(st.floats(-0.25, 0.05), min_size=4, max_size=4), seeds)
def test_the_inverse_of_two_lenses_is_exact(bends, seed):
    family = ProjectiveRadial(fixed_coefficients=2, moving_coefficients=2)
    plane = [0.8, 0.01, -0.02, 0.81, *(MOVING.centre - FIXED.centre), 0.02, -0.03]
    warp = Warp(family, np.array([*plane, *np.array(bends) * [1, 0.2, 1, 0.2]]), FRAME)
    at = points(seed)
    there = warp(at)
    seen = MOVING.inside(MOVING.indices(there))

    back = warp.inverse()

    assert back.frame.grid == MOVING
    np.testing.assert_allclose(back(there)[seen], at[seen], rtol=0, atol=1e-6)


@given(st.floats(-6, 6), st.floats(-6, 6), st.floats(-3, 3), st.floats(-3, 3), seeds)
def test_points_without_an_image_are_outside_and_never_nan(px, py, first, second, seed):
    """Whatever the parameters, every value is finite, and what has no image has weight 0."""
    plane = [*drawn(seed)[:6], px, py]
    image = np.random.default_rng(seed).random(MOVING.shape)
    families = {Projective(): plane, ProjectiveRadial(moving_coefficients=2): [*plane, first, second]}
    small = FIXED.coarsen(16)
    for family, params in families.items():
        warp = Warp(family, np.array(params), FRAME)

        mapped = warp(small.points(small.all_indices()))
        values, inside = resample(image, MOVING, small, warp, Linear())

        assert np.isfinite(mapped).all()
        assert np.isfinite(values).all()
        lost = (np.abs(mapped).max(axis=1) > LOST).reshape(small.shape)
        assert not inside[lost].any()


def test_the_slope_ignores_points_without_an_image():
    params = np.array([1.0, 0, 0, 1.0, 0, 0, 3.0, 0.0])
    at = np.array([[0.0, 240.0], [600.0, 240.0]])

    both = PLANE.parameter_gradient(params, at, np.ones((2, 2)), FRAME)
    seen = PLANE.parameter_gradient(params, at[1:], np.ones((1, 2)), FRAME)

    assert np.abs(PLANE.map(params, at, FRAME)[0]).max() >= FAR
    np.testing.assert_array_equal(both, seen)


def test_what_one_map_loses_no_other_brings_back():
    lost = Warp(PLANE, np.array([1.0, 0, 0, 1.0, 0, 0, 3.0, 0.0]), FRAME)
    other = Warp(PLANE, np.array([1.0, 0, 0, 1.0, 0, 0, 0.5, 0.5]), FRAME)

    there = (other @ lost)(np.array([[0.0, 240.0]]))

    assert np.abs(there).max() >= LOST


def test_a_centre_beyond_the_horizon_is_refused():
    behind = np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 10.0]])

    with pytest.raises(GeometryError, match="beyond its horizon"):
        Homography.of_homogeneous(behind, FIXED.centre)


def test_a_singular_homography_has_no_inverse():
    with pytest.raises(GeometryError, match="singular"):
        inverted(np.ones((3, 3)))


def test_an_image_of_a_homography_is_opencvs():
    cv2 = pytest.importorskip("cv2")
    image = Image.of_array(np.random.default_rng(1).random(MOVING.shape).astype(np.float32))
    warp = Warp(PLANE, np.array([0.8, 0.05, -0.02, 0.7, -60.0, -90.0, 0.05, -0.08]), FRAME)

    values, inside = resample(image.values, MOVING, FIXED, warp, Linear())

    theirs = cv2.warpPerspective(
        image.values, warp.as_homogeneous(), (640, 480), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    )
    inner = cv2.erode(inside.astype(np.uint8), np.ones((5, 5))) > 0
    # OpenCV rounds positions to 1/32 of a pixel, and neighbours differ by up to 1.
    assert np.abs(values - theirs)[inner].mean() < 0.02
