"""Laws that every shipped linear family obeys, for any frame and parameters."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from properties.strategies import affine_maps, dimensions, floats, frames, seeds

from regframe.transforms.affine import Affine, factors, from_factors
from regframe.transforms.rigid import Rigid
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.versor_rigid import VersorRigid
from regframe.transforms.warp import Warp

FAMILIES = [Translation(), Rigid(), Rigid(order="zyx"), Similarity(), VersorRigid(), Affine()]
# Points lie within some 1e3 mm of the origin and maps stretch by less than 10.
ROUNDING = 1e-8
by_name = pytest.mark.parametrize("family", FAMILIES, ids=lambda family: type(family).__name__)


def draw_warp(data, family, frame):
    """A member of a family: the one nearest to some affine map, which is never singular."""
    affine = data.draw(affine_maps(frame.dim, mirrors=False))
    return Warp(family, family.from_affine(affine, frame), frame)


def draw_frame(data, family):
    return data.draw(frames(data.draw(st.sampled_from(family.dimensions))))


def points_near(frame, seed):
    return frame.centre + np.random.default_rng(seed).uniform(-100.0, 100.0, (12, frame.dim))


@by_name
@given(st.data(), seeds)
def test_families_are_closed_under_composition(family, data, seed):
    frame = draw_frame(data, family)
    first, second = draw_warp(data, family, frame), draw_warp(data, family, frame)
    points = points_near(frame, seed)

    both = (second @ first).as_affine()
    member = Warp(family, family.from_affine(both, frame), frame)

    np.testing.assert_allclose(member(points), second(first(points)), rtol=0, atol=ROUNDING)


@by_name
@given(st.data(), seeds)
def test_families_are_closed_under_inversion(family, data, seed):
    frame = draw_frame(data, family)
    warp = draw_warp(data, family, frame)
    points = points_near(frame, seed)

    np.testing.assert_allclose(warp.inverse()(warp(points)), points, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(warp(warp.inverse()(points)), points, rtol=0, atol=ROUNDING)


@by_name
@given(st.data(), seeds)
def test_identity_is_neutral(family, data, seed):
    frame = draw_frame(data, family)
    warp, neutral = draw_warp(data, family, frame), Warp(family, family.identity(frame), frame)
    points = points_near(frame, seed)

    np.testing.assert_allclose((neutral @ warp)(points), warp(points), rtol=0, atol=ROUNDING)
    np.testing.assert_allclose((warp @ neutral)(points), warp(points), rtol=0, atol=ROUNDING)


@by_name
@given(st.data())
def test_nearest_member_of_a_member_is_itself(family, data):
    frame = draw_frame(data, family)
    warp = draw_warp(data, family, frame)

    again = family.from_affine(warp.as_affine(), frame)

    np.testing.assert_allclose(again, warp.params, rtol=0, atol=ROUNDING)


@by_name
@given(st.data(), seeds)
def test_parameter_gradient_is_linear_in_forces(family, data, seed):
    frame = draw_frame(data, family)
    warp = draw_warp(data, family, frame)
    points = points_near(frame, seed)
    one, other = np.random.default_rng((seed, 1)).standard_normal((2, *points.shape))

    def pull(forces):
        return family.parameter_gradient(warp.params, points, forces, frame)

    np.testing.assert_allclose(pull(one + 2 * other), pull(one) + 2 * pull(other), rtol=1e-9, atol=ROUNDING)


@by_name
@given(st.data(), seeds)
def test_parameter_gradient_adds_over_points(family, data, seed):
    frame = draw_frame(data, family)
    warp = draw_warp(data, family, frame)
    points = points_near(frame, seed)
    forces = np.random.default_rng((seed, 1)).standard_normal(points.shape)

    parts = [family.parameter_gradient(warp.params, points[i::2], forces[i::2], frame) for i in (0, 1)]

    whole = family.parameter_gradient(warp.params, points, forces, frame)
    np.testing.assert_allclose(parts[0] + parts[1], whole, rtol=1e-9, atol=ROUNDING)


@given(st.data(), dimensions, seeds)
def test_the_frames_centre_never_changes_the_map(data, dim, seed):
    """Parameters speak of a centre; the affine map they stand for does not."""
    affine = data.draw(affine_maps(dim))
    one, other = data.draw(frames(dim)), data.draw(frames(dim))
    points = points_near(one, seed)

    np.testing.assert_allclose(
        Warp.of_affine(affine, one)(points), Warp.of_affine(affine, other)(points), rtol=0, atol=ROUNDING
    )


@given(st.data())
def test_smaller_families_keep_the_centre_of_larger_ones(data):
    frame = data.draw(frames(data.draw(dimensions)))
    affine = data.draw(affine_maps(frame.dim))

    for family in (one for one in FAMILIES if frame.dim in one.dimensions):
        nearest = Warp(family, family.from_affine(affine, frame), frame)
        np.testing.assert_allclose(
            nearest(frame.centre[None]), affine(frame.centre[None]), rtol=0, atol=ROUNDING
        )


@given(
    floats(-100, 100),
    floats(-3.1, 3.1),
    floats(0.3, 3.0),
    floats(0.3, 3.0),
    floats(-0.8, 0.8),
    floats(-0.8, 0.8),
)
def test_factors_of_a_map_give_the_same_map(shift, angle, scale_x, scale_y, shear_x, shear_y):
    params = from_factors(
        {
            "tx": shift,
            "rotation_rad": angle,
            "scale_x": scale_x,
            "scale_y": scale_y,
            "shear_x": shear_x,
            "shear_y": shear_y,
        }
    )

    again = from_factors(factors(params[:4].reshape(2, 2), params[4:]))

    np.testing.assert_allclose(again, params, rtol=0, atol=1e-12)
