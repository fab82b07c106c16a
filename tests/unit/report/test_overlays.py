import numpy as np
import pytest

from regframe.report.overlays import checkerboard, difference, draw, overlays, red_cyan
from regframe.report.planes import Plane
from support.results import image, ramp, result


def plane(fixed, moving, inside=True):
    shape = np.shape(fixed)
    return Plane(np.float32(fixed), np.float32(moving), np.broadcast_to(inside, shape))


def test_red_cyan_is_grey_where_both_agree():
    shades = np.linspace(0, 1, 12).reshape(3, 4)

    picture = red_cyan(plane(shades, shades))

    assert np.array_equal(picture[..., 0], picture[..., 1])
    assert np.array_equal(picture[..., 1], picture[..., 2])


def test_red_cyan_shows_fixed_red_and_moving_cyan():
    picture = red_cyan(plane([[1.0, 0.0]], [[0.0, 1.0]]))

    assert picture.tolist() == [[[255, 0, 0], [0, 255, 255]]]


@pytest.mark.parametrize("paint", [red_cyan, difference, checkerboard])
def test_outside_the_overlap_the_fixed_image_stays_in_dim_grey(paint):
    picture = paint(plane([[1.0] * 9], [[0.0] * 9], inside=False))

    assert (np.ptp(picture, axis=-1) == 0).all()
    assert (picture < 128).all()
    assert (picture > 80).all()


def test_difference_is_white_where_both_agree():
    assert (difference(plane([[0.2, 0.9]], [[0.2, 0.9]])) == 255).all()


def test_difference_tells_by_colour_which_image_is_brighter():
    picture = difference(plane([[1.0, 0.0]], [[0.0, 1.0]])).astype(int)

    assert picture[0, 0, 0] > picture[0, 0, 2]
    assert picture[0, 1, 0] < picture[0, 1, 2]


def test_checkerboard_holds_equal_parts_of_both():
    picture = checkerboard(plane(np.zeros((64, 64)), np.ones((64, 64))))

    assert picture.mean() == pytest.approx(127.5)
    assert picture[0, 0].tolist() == [0, 0, 0]
    assert picture[0, 8].tolist() == [255, 255, 255]


def test_several_planes_stand_side_by_side_on_white():
    small, tall = plane(np.zeros((4, 3)), np.zeros((4, 3))), plane(np.zeros((10, 5)), np.zeros((10, 5)))

    picture = draw([small, tall], red_cyan)

    assert picture.shape == (10, 3 + 6 + 5, 3)
    assert (picture[0, 0] == 255).all()
    assert (picture[5, 0] == 0).all()


def test_a_flat_result_gives_four_pictures_of_the_fixed_size():
    pictures = overlays(result())

    assert list(pictures) == ["red-cyan", "difference", "checkerboard", "before"]
    assert all(picture.shape == (12, 16, 3) for picture in pictures.values())
    assert all(picture.dtype == np.uint8 for picture in pictures.values())


def test_before_shows_the_start():
    made = result(shift=(3, 0))

    pictures = overlays(made)

    assert np.ptp(pictures["before"], axis=-1).max() == 0
    assert np.ptp(pictures["red-cyan"], axis=-1).max() > 0


def test_volumes_give_three_panels():
    one = image(ramp((6, 8, 10), np.float32), "volume")

    picture = overlays(result(one, one, shift=(0, 0, 0)))["red-cyan"]

    assert picture.shape[1] > 2 * picture.shape[0]
