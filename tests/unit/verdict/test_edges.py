import numpy as np
import pytest

from regframe.geometry import Frame, Grid
from regframe.image import Image
from regframe.testing.phantoms import misalignment
from regframe.transforms.affine import Affine
from regframe.transforms.warp import Warp
from regframe.verdict import edges

WHOLE = np.ones((40, 60), bool)


def ramp(angle_deg):
    """An image that rises along a direction, and its edges everywhere alike."""
    angle = np.deg2rad(angle_deg)
    down, across = np.indices(WHOLE.shape, dtype=np.float64)
    return np.cos(angle) * across + np.sin(angle) * down


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 90.0, 150.0])
def test_a_field_points_along_twice_the_angle(angle_deg):
    field = edges.edges(ramp(angle_deg), WHOLE).field[20, 30]

    assert np.angle(field * np.exp(-2j * np.deg2rad(angle_deg))) == pytest.approx(0.0, abs=1e-5)


def test_reversed_contrast_has_the_same_edges():
    image = np.random.default_rng(1).standard_normal(WHOLE.shape)

    assert np.allclose(edges.edges(image, WHOLE).field, edges.edges(-image, WHOLE).field, atol=1e-6)


def test_brightness_and_contrast_do_not_matter():
    image = np.random.default_rng(1).standard_normal(WHOLE.shape)

    assert np.allclose(
        edges.edges(image, WHOLE).field, edges.edges(7900.0 + 35.0 * image, WHOLE).field, atol=1e-3
    )


def test_a_constant_image_has_no_edges():
    assert not edges.edges(np.full(WHOLE.shape, 3.0), WHOLE).field.any()


def test_missing_pixels_make_no_edges():
    inside = WHOLE.copy()
    inside[:, :25] = False
    image = np.where(inside, 100.0 + 0.0 * ramp(0.0), 0.0)

    found = edges.edges(image, inside)

    assert not found.field.any()
    assert not found.weight[:, : 25 + edges.RIM - 1].any()


def test_an_image_that_is_nowhere_has_no_edges():
    found = edges.edges(np.zeros(WHOLE.shape), ~WHOLE)

    assert not found.field.any()
    assert not found.weight.any()


def test_masked_pixels_do_not_count(street):
    mask = np.ones(street.fixed.grid.shape, bool)
    mask[:, :160] = False

    _, below, _ = edges.pair(street.fixed.with_mask(mask), street.moving, street.truth)

    assert not below.weight[:, :160].any()
    assert below.weight[:, 170:].any()


@pytest.mark.parametrize(("shape", "width"), [((120, 160), 160), ((512, 640), 320), ((1080, 1920), 320)])
def test_edges_are_compared_on_a_small_grid(shape, width):
    assert edges.working_grid(Grid.of_shape(shape)).shape[1] == width


def test_stretch_is_moving_length_over_fixed_length():
    grids = Grid.of_shape((480, 640)), Grid.of_shape((240, 320))

    assert edges.stretch(misalignment(*grids, angle_deg=20.0, scale=1.5), grids[0]) == pytest.approx(0.75)


def test_a_map_onto_one_point_has_no_stretch_of_its_own():
    grid = Grid.of_shape((20, 30))

    assert edges.stretch(Warp(Affine(), np.zeros(6), Frame.about_centre(grid)), grid) == 1.0


def test_the_moving_edges_lie_where_the_map_puts_them(street):
    _, below, above = edges.pair(street.fixed, street.moving, street.truth)

    agreement = float((np.conj(below.field) * above.field).real.sum())
    shifted = float((np.conj(below.field) * np.roll(above.field, 8, axis=1)).real.sum())
    assert agreement > 2.0 * abs(shifted)


def test_a_map_that_leaves_the_image_shows_nothing(street, beside):
    far = beside(shift_px=(5000.0, 0.0))

    _, _, above = edges.pair(street.fixed, street.moving, far)

    assert not above.weight.any()


def test_tiny_images_can_be_looked_at():
    tiny = Image.of_array(np.random.default_rng(1).random((4, 5)))

    grid, below, _ = edges.pair(tiny, tiny, misalignment(tiny.grid, tiny.grid))

    assert below.field.shape == grid.shape == (4, 5)
