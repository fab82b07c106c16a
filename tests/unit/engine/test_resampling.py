import numpy as np
import pytest

from regframe.engine.resampling import align
from regframe.geometry import AffineMap, Frame, Grid
from regframe.image import Image
from regframe.interpolators.bspline import BSpline
from regframe.interpolators.linear import Linear
from regframe.interpolators.nearest import Nearest
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Warp
from support.results import image, ramp


def moved(grid, *shift):
    return Warp(Translation(), np.array(shift, dtype=np.float64), Frame.about_centre(grid))


class Bent:
    """A shift that says it is not affine, and so takes the way by points."""

    def __init__(self, grid, *shift):
        self.warp = moved(grid, *shift)

    def __call__(self, points):
        return self.warp(points)

    def as_affine(self):
        return None


@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.uint16, np.float32, np.float64])
def test_keeps_the_number_type(dtype):
    one = image(ramp((6, 8), dtype), "moving")

    assert align(one, one.grid, moved(one.grid, 0.5, 0.25)).dtype == dtype


def test_whole_shifts_move_pixels_exactly():
    one = image(ramp((6, 8), np.uint16), "moving")

    aligned = align(one, one.grid, moved(one.grid, 2, 1))

    assert np.array_equal(aligned[:5, :6], one.raw[1:, 2:])


def test_integers_are_rounded_to_the_nearest():
    one = image(np.array([[0, 1, 2, 3], [0, 1, 2, 3]], np.uint8), "moving")

    aligned = align(one, one.grid, moved(one.grid, 0.6, 0), Linear())

    assert aligned[0, :3].tolist() == [1, 2, 3]


def test_integers_are_clipped_to_their_range():
    pixels = np.zeros((8, 8), np.uint8)
    pixels[:, 4:] = 255
    one = image(pixels, "moving")
    aligned = align(one, one.grid, moved(one.grid, 0.4, 0))

    # The spline overshoots on both sides of the edge; wrapped numbers would lie in between.
    assert aligned[0, 2] == 0
    assert aligned[0, 4] == 255


def test_colour_is_kept():
    colour = np.random.default_rng(1).integers(0, 256, (6, 8, 3), dtype=np.uint8)
    one = image(colour, "moving")

    aligned = align(one, one.grid, moved(one.grid, 1, 0))

    assert np.array_equal(aligned[:, :7], colour[:, 1:])


def test_masks_stay_masks():
    one = image(np.eye(6, dtype=np.bool_), "moving")

    assert align(one, one.grid, moved(one.grid, 0.2, 0)).dtype == np.bool_


def test_outside_gets_the_fill():
    one = image(ramp((6, 8)), "moving")

    aligned = align(one, one.grid, moved(one.grid, 5, 0), fill=9)

    assert (aligned[:, 3:] == 9).all()


def test_the_result_has_the_shape_of_the_grid():
    one = image(ramp((6, 8)), "moving")
    grid = Grid.of_shape((11, 3))

    assert align(one, grid, moved(grid, 0, 0)).shape == (11, 3)


def test_spacings_of_both_grids_count():
    fine = image(np.repeat(np.arange(8, dtype=np.float32)[None], 4, axis=0), "moving", spacing=(0.5, 0.5))
    grid = Grid((2, 4), (1.0, 1.0), (0.0, 0.0), fine.grid.direction)

    aligned = align(fine, grid, moved(grid, 0, 0), Linear())

    assert aligned[0].tolist() == [0, 2, 4, 6]


@pytest.mark.parametrize("shape", [(6, 8), (4, 6, 8)])
def test_both_ways_through_a_warp_agree(shape):
    one = image(ramp(shape, np.float64), "moving")
    shift = (0.3, -0.7, 1.2)[: len(shape)]

    fast = align(one, one.grid, moved(one.grid, *shift))
    slow = align(one, one.grid, Bent(one.grid, *shift))

    assert np.allclose(fast, slow, atol=1e-9)


def test_cubic_splines_are_the_default():
    one = image(ramp((6, 8), np.float64) ** 2, "moving")
    there = moved(one.grid, 0.4, 0.3)

    assert np.array_equal(align(one, one.grid, there), align(one, one.grid, there, BSpline(order=3)))


def test_the_interpolator_can_be_chosen():
    one = image(ramp((6, 8)), "moving")

    aligned = align(one, one.grid, moved(one.grid, 0.4, 0), Nearest())

    assert np.array_equal(aligned, one.raw)


def test_volumes_three_pixels_wide_are_no_colour():
    pixels = ramp((5, 6, 3), np.float32)
    volume = Image(pixels, Grid.of_shape(pixels.shape), raw=pixels)
    stay = Warp.of_affine(AffineMap.identity(3), Frame.about_centre(volume.grid))

    assert np.array_equal(align(volume, volume.grid, stay, Linear()), pixels)
