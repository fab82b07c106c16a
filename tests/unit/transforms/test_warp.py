"""Warps and chains as values."""

import numpy as np
import pytest

from regframe.errors import GeometryError
from regframe.geometry import AffineMap, Frame, Grid
from regframe.transforms.affine import Affine
from regframe.transforms.base import Transform
from regframe.transforms.rigid import Rigid
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Chain, Warp, chain

FRAME = Frame.about_centre(Grid.of_shape((21, 31)))
POINTS = np.array([[0.0, 0.0], [4.0, 7.0], [30.0, -5.0]])


class Wave(Transform):
    """Not affine."""

    def identity(self, frame):
        return np.zeros(1)

    def map(self, params, points, frame):
        return points + params[0] * np.sin(points)


def shift():
    return Warp(Translation(), np.array([3.0, -1.0]), FRAME)


def turned():
    return Warp(Similarity(), np.array([1.2, 0.3, 5.0, 2.0]), FRAME)


def wave():
    return Warp(Wave(), np.array([0.5]), FRAME)


def test_call_maps_points():
    assert shift()(POINTS).tolist() == (POINTS + np.array([3.0, -1.0])).tolist()


def test_matmul_applies_the_right_one_first():
    both = turned() @ shift()

    assert np.allclose(both(POINTS), turned()(shift()(POINTS)), atol=1e-12)


@pytest.mark.parametrize("left_first", [lambda a, b, c: (a @ b) @ c, lambda a, b, c: a @ (b @ c)])
def test_chains_join_whichever_is_made_first(left_first):
    both = left_first(turned(), shift(), wave())

    assert len(both.warps) == 3
    assert np.allclose(both(POINTS), turned()(shift()(wave()(POINTS))), atol=1e-12)


def test_chain_of_affine_warps_is_affine():
    both = turned() @ shift()

    assert np.allclose(both.as_affine()(POINTS), both(POINTS), atol=1e-12)


def test_chain_with_another_warp_is_not_affine():
    assert (turned() @ wave()).as_affine() is None


def test_chain_inverts_in_reverse_order():
    both = turned() @ shift()

    assert np.allclose((both.inverse() @ both)(POINTS), POINTS, atol=1e-12)
    assert np.allclose((both @ both.inverse())(POINTS), POINTS, atol=1e-12)


def test_inverse_stays_in_the_family():
    back = turned().inverse()

    assert isinstance(back.transform, Similarity)
    assert np.allclose(back(turned()(POINTS)), POINTS, atol=1e-12)


def test_inverse_of_what_is_not_affine_is_refused():
    with pytest.raises(GeometryError, match="Wave has no closed inverse"):
        wave().inverse()


def test_inverse_of_a_collapsed_warp_is_refused():
    flat = Warp(Similarity(), np.array([0.0, 0.0, 1.0, 1.0]), FRAME)

    with pytest.raises(GeometryError, match="cannot be inverted"):
        flat.inverse()


def test_warp_of_an_affine_map_is_that_map():
    affine = AffineMap(np.array([[1.1, 0.2], [-0.1, 0.9]]), np.array([4.0, 5.0]))

    warp = Warp.of_affine(affine, FRAME)

    assert isinstance(warp.transform, Affine)
    assert np.allclose(warp(POINTS), affine(POINTS), atol=1e-12)


def test_chain_speaks_of_the_frame_it_meets_first():
    other = Frame.about_centre(Grid.of_shape((5, 5)))
    last = Warp(Rigid(), np.zeros(3), other)

    assert (last @ shift()).frame is FRAME


def test_one_warp_is_no_chain():
    warp = shift()

    assert chain([warp]) is warp


def test_several_warps_are_a_chain():
    both = chain([turned(), shift()])

    assert isinstance(both, Chain)
    assert np.allclose(both(POINTS), turned()(shift()(POINTS)), atol=1e-12)


def test_a_family_without_it_cannot_start_from_an_affine_map():
    with pytest.raises(GeometryError, match="Wave cannot start from a given affine map"):
        Wave().from_affine(AffineMap.identity(2), FRAME)


def test_unnamed_parameters_are_numbered():
    assert Wave().names(FRAME) == ("p0",)
