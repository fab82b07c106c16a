"""Phantoms: what they promise about their truth, their pixels and their independence."""

import numpy as np
import pytest
from scipy import ndimage

from regframe.errors import GeometryError
from regframe.geometry import Frame, Grid
from regframe.testing.phantoms import (
    corner_error,
    draw_misalignment,
    misalignment,
    smooth_pair,
    visual_thermal,
)
from regframe.transforms.affine import Affine, from_factors
from regframe.transforms.base import Transform
from regframe.transforms.projective_radial import ProjectiveRadial
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Warp

SHAPE = (150, 200)
GRID = Grid.of_shape(SHAPE)


def thermal(truth, **options):
    """Thermal values of the small street without noise."""
    phantom = visual_thermal(1, SHAPE, thermal_shape=SHAPE, truth=truth, noise=0.0, **options)
    return np.asarray(phantom.moving.values, np.float64)


def still():
    return misalignment(GRID, GRID)


def correlation(one, other):
    return float(np.corrcoef(np.ravel(one), np.ravel(other))[0, 1])


class Wavy(Transform):
    """Not affine."""

    def identity(self, frame):
        return np.zeros(1)

    def map(self, params, points, frame):
        return points + params[0] * np.sin(points)


def test_same_seed_gives_same_pixels():
    one, other = visual_thermal(4, SHAPE), visual_thermal(4, SHAPE)

    assert np.array_equal(one.fixed.raw, other.fixed.raw)
    assert np.array_equal(one.moving.raw, other.moving.raw)
    assert np.array_equal(one.truth.params, other.truth.params)


def test_another_seed_gives_another_scene():
    one, other = visual_thermal(4, SHAPE), visual_thermal(5, SHAPE)

    assert abs(correlation(one.fixed.values, other.fixed.values)) < 0.8
    assert corner_error(one.truth, other.truth, one.fixed.grid) > 1.0


def test_truth_does_not_change_the_visual_frame():
    plain = visual_thermal(2, SHAPE)

    moved = visual_thermal(
        2, SHAPE, thermal_shape=(90, 120), truth=misalignment(GRID, Grid.of_shape((90, 120)))
    )

    assert np.array_equal(plain.fixed.raw, moved.fixed.raw)


def test_visual_frame_has_8_bits_and_uses_them():
    visual = visual_thermal(1, SHAPE).fixed.raw

    assert visual.dtype == np.uint8
    assert np.percentile(visual, 99) - np.percentile(visual, 1) > 150


def test_thermal_frame_has_14_bit_counts_in_16_bits():
    counts = visual_thermal(1, SHAPE).moving.raw

    assert counts.dtype == np.uint16
    assert counts.min() > 7000
    assert counts.max() < 9600


def test_thermal_frame_may_have_any_size():
    phantom = visual_thermal(1, SHAPE, thermal_shape=(61, 77))

    assert phantom.moving.grid.shape == (61, 77)


def test_hot_pixels_stand_at_both_ends_of_the_scale():
    counts = visual_thermal(1, SHAPE, hot_pixels=6).moving.raw

    assert int((counts == 16383).sum()) == 3
    assert int((counts == 0).sum()) == 3


def test_noise_can_be_left_out():
    smooth, noisy = (visual_thermal(1, SHAPE, noise=noise).moving.values for noise in (0.0, 1.0))

    assert 2.0 < np.std(np.asarray(noisy, np.float64) - smooth) < 12.0


@pytest.mark.parametrize("shift", [(0.37, -0.21), (-3.4, 2.6)])
def test_truth_holds_below_two_hundredths_of_a_pixel(shift):
    """A shifted truth moves the frame by that much, measured from the intensities alone."""
    inner = (slice(12, -12), slice(12, -12))

    moved = thermal(misalignment(GRID, GRID, shift_px=shift))
    expected = ndimage.shift(thermal(still()), shift[::-1], order=5)

    down, across = np.gradient(expected)
    slopes = np.column_stack([across[inner].ravel(), down[inner].ravel(), np.ones(across[inner].size)])
    left = np.linalg.lstsq(slopes, (expected - moved)[inner].ravel(), rcond=None)[0]
    assert np.abs(left[:2]).max() < 0.02


@pytest.mark.parametrize("options", [{"angle_deg": 12.0}, {"scale": 1.3}, {"angle_deg": -5.0, "scale": 0.9}])
def test_truth_holds_for_rotation_and_scale(options):
    """Read at the true places, the warped frame is the unwarped one; no affine motion is left over."""
    truth = misalignment(GRID, GRID, **options)
    points = GRID.points(GRID.all_indices())
    unwarped, moved = thermal(still()), thermal(truth)

    places = truth(points)
    kept = np.all((places > 6) & (places < np.array(SHAPE[::-1]) - 7), axis=1)
    got = ndimage.map_coordinates(moved, places[kept, ::-1].T, order=5)
    wanted = unwarped.ravel()[kept]
    slopes = np.stack(np.gradient(unwarped)[::-1], axis=-1).reshape(-1, 2)[kept]
    place = np.column_stack([np.ones(len(got)), (points[kept] - GRID.centre) / 100.0])
    # Lenses differ by a ring of warmth and by sharpness, which a second derivative stands for.
    rings = np.column_stack([place, place[:, 1:] ** 2, ndimage.laplace(unwarped).ravel()[kept]])
    terms = np.column_stack([slopes[:, :1] * place, slopes[:, 1:] * place, rings])
    left = np.linalg.lstsq(terms, got - wanted, rcond=None)[0][:6]
    assert np.abs(left).max() < 0.02


def test_truth_may_be_affine():
    truth = Warp(
        Affine(), from_factors({"scale_x": 1.1, "shear_x": 0.05, "tx": 4.0}), Frame.about_centre(GRID)
    )

    phantom = visual_thermal(1, SHAPE, thermal_shape=SHAPE, truth=truth)

    assert phantom.truth is truth


def test_truth_may_bend_as_a_lens_does():
    frame = Frame.about_centre(GRID, GRID)
    truth = Warp(ProjectiveRadial(), np.array([1.1, 0, 0, 1.1, 2.0, 0, 0.02, 0, -0.05]), frame)

    phantom = visual_thermal(1, SHAPE, thermal_shape=SHAPE, truth=truth, noise=0.0)
    straight = visual_thermal(
        1, SHAPE, thermal_shape=SHAPE, truth=Warp(Affine(), truth.params[:6], frame), noise=0.0
    )

    # The same middle, another rim.
    gap = np.abs(phantom.moving.values - straight.moving.values)
    assert gap[44:52, 60:68].mean() < gap[:8].mean() / 3


def test_truth_without_an_inverse_is_refused():
    truth = Warp(Wavy(), np.array([2.0]), Frame.about_centre(GRID))

    with pytest.raises(GeometryError, match="no closed inverse"):
        visual_thermal(1, SHAPE, truth=truth)


def test_truth_that_looks_past_the_scene_is_refused():
    with pytest.raises(GeometryError, match="past the painted scene"):
        visual_thermal(1, SHAPE, truth=misalignment(GRID, GRID, shift_px=(400.0, 0.0)))


def test_frames_are_not_simply_related():
    """Aligned, the two frames neither rise together nor against each other."""
    phantom = visual_thermal(1, SHAPE, thermal_shape=SHAPE, truth=still())

    below_the_sky = slice(60, None)
    found = correlation(phantom.fixed.values[below_the_sky], phantom.moving.values[below_the_sky])
    assert abs(found) < 0.4


@pytest.fixture(scope="module")
def mattes():
    """SimpleITK's Mattes mutual information of a street, by motion away from the truth in pixels."""
    import SimpleITK as sitk

    phantom = visual_thermal(1, (240, 320))
    images = [sitk.GetImageFromArray(image.values) for image in (phantom.fixed, phantom.moving)]
    method = sitk.ImageRegistrationMethod()
    method.SetMetricAsMattesMutualInformation(50)
    method.SetMetricUseMovingImageGradientFilter(False)
    method.SetInterpolator(sitk.sitkBSpline)
    transform = sitk.Similarity2DTransform()
    transform.SetCenter(phantom.truth.frame.centre.tolist())
    # One unit of scale or angle moves a corner by 200 px.
    reach = np.array([200.0, 200.0, 1.0, 1.0])

    def value(parameter, pixels):
        params = phantom.truth.params.copy()
        params[parameter] += pixels / reach[parameter]
        transform.SetParameters(params.tolist())
        method.SetInitialTransform(transform, inPlace=True)
        return method.MetricEvaluate(*images)

    return value


@pytest.mark.parametrize("parameter", range(4), ids=["scale", "angle", "tx", "ty"])
def test_mutual_information_is_best_at_the_truth(mattes, parameter):
    """The vertex of a parabola through five values lies within 0.2 px of the truth."""
    steps = np.linspace(-0.4, 0.4, 5)

    curvature, slope, _ = np.polyfit(steps, [mattes(parameter, step) for step in steps], 2)

    assert curvature > 0.0
    assert abs(slope / (2.0 * curvature)) < 0.2


@pytest.mark.parametrize("parameter", range(4), ids=["scale", "angle", "tx", "ty"])
@pytest.mark.parametrize("side", [-1, 1])
def test_mutual_information_leads_to_the_truth_from_afar(mattes, parameter, side):
    found = [mattes(parameter, side * pixels) for pixels in (0, 2, 5, 10, 20)]

    assert found == sorted(found)


def test_drawn_misalignment_is_that_of_hand_mounted_cameras():
    fixed, moving = Grid.of_shape((480, 640)), Grid.of_shape((384, 512))

    for seed in range(20):
        scale, angle, *_ = draw_misalignment(seed, fixed, moving).params
        off = draw_misalignment(seed, fixed, moving)(fixed.centre[None])[0] - moving.centre
        assert 3.0 <= np.rad2deg(abs(angle)) <= 4.0
        assert 1.04 <= max(scale / 0.8, 0.8 / scale) <= 1.06
        assert 15.0 <= np.hypot(*off) / 0.8 <= 20.0


def test_no_misalignment_means_equal_fields_of_view():
    fixed, moving = Grid.of_shape((48, 64)), Grid.of_shape((24, 32))

    corners = misalignment(fixed, moving)(fixed.points(np.array([[-0.5, -0.5], [47.5, 63.5]])))

    assert np.allclose(corners, [[-0.5, -0.5], [31.5, 23.5]], atol=1e-12)


def test_corner_error_is_the_mean_distance():
    frame = Frame.about_centre(Grid.of_shape((11, 21)))
    turned, still_one = (
        Warp(Affine(), params, frame) for params in (from_factors({"scale_x": 1.2}), from_factors({}))
    )

    assert corner_error(turned, still_one, frame.grid) == pytest.approx(0.2 * 10.0)


def test_corner_error_is_in_the_unit_of_the_grid():
    grid = Grid((5, 6, 7), (2.0, 2.0, 3.0), (0.0, 0.0, 0.0), tuple(map(tuple, np.eye(3))))
    shifted, still_one = (
        Warp(Translation(), np.array(t), Frame.about_centre(grid)) for t in ([0, 0, 3.0], [0, 0, 0.0])
    )

    assert corner_error(shifted, still_one, grid) == pytest.approx(3.0)


@pytest.mark.parametrize("shape", [(30, 36), (14, 15, 16)])
@pytest.mark.parametrize(
    ("kind", "low", "high"), [("mono", 0.99, 1.0), ("inverted", -1.0, -0.99), ("multimodal", -0.5, 0.5)]
)
def test_smooth_pair_relates_as_its_kind_says(kind, low, high, shape):
    pair = smooth_pair(kind, shape)

    found = correlation(pair.fixed.values, pair.moving.values)
    assert low <= found <= high
    assert pair.fixed.grid.shape == shape


def test_smooth_pair_is_aligned():
    pair = smooth_pair("mono", (30, 36))

    assert np.array_equal(pair.truth.params, [0.0, 0.0])
