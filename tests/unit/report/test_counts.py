import numpy as np
import pytest

from regframe.report.counts import courses, histogram, joint_histogram, mutual_information
from support.results import image, ramp, result


def test_every_pixel_is_counted():
    counts, _ = histogram(image(ramp((12, 16)), "fixed"))

    assert counts.sum() == 12 * 16
    assert len(counts) == 256


@pytest.mark.parametrize("levels", [40, 300, 5000])
def test_bins_of_integer_images_are_whole_grey_levels_wide(levels):
    pixels = np.arange(7000, 7000 + levels, dtype=np.uint16).reshape(20, -1)

    counts, edges = histogram(image(pixels, "thermal"))

    assert len(counts) == 256
    assert len(set(counts[counts > 0][:-1])) == 1
    assert edges[0] == 6999.5


def test_real_numbers_are_cut_into_256_bins():
    counts, edges = histogram(image(np.linspace(-1, 1, 600, dtype=np.float32).reshape(20, 30), "field"))

    assert len(counts) == 256
    assert edges[0] == -1
    assert edges[-1] == 1


def test_a_constant_image_has_a_histogram():
    counts, _ = histogram(image(np.full((4, 5), 0.5, np.float32), "flat"))

    assert counts.max() == 20


def test_masked_pixels_are_not_counted():
    mask = np.zeros((12, 16), bool)
    mask[2:5, 2:6] = True

    counts, _ = histogram(image(ramp((12, 16)), "fixed").with_mask(mask))

    assert counts.sum() == 12


def test_equal_images_meet_on_the_diagonal():
    one = image(ramp((24, 32)), "fixed")

    table = joint_histogram(result(one, one, shift=(0, 0)), result(one, one, shift=(0, 0)).warp)

    assert np.count_nonzero(table.counts) == np.count_nonzero(np.diag(table.counts))
    assert table.counts.sum() == 24 * 32


def test_only_pixels_inside_both_masks_meet():
    mask = np.zeros((12, 16), bool)
    mask[:, 8:] = True
    fixed = image(ramp((12, 16)), "fixed").with_mask(mask)
    moving = image(ramp((12, 16)), "moving").with_mask(np.roll(mask, 4, axis=1))
    made = result(fixed, moving, shift=(0, 0))

    assert joint_histogram(made, made.warp).counts.sum() == 12 * 4


def test_mutual_information_of_independent_values_is_zero():
    assert mutual_information(np.outer([1.0, 2.0, 3.0], [4.0, 5.0])) == pytest.approx(0, abs=1e-12)


def test_mutual_information_of_nothing_is_zero():
    assert mutual_information(np.zeros((4, 4))) == 0


def test_levels_follow_each_other_along_the_evaluations():
    first, second = courses(result())

    assert (first.first, first.last, second.first, second.last) == (0, 6, 6, 12)
    assert second.evaluations.tolist() == [8, 9, 10, 11, 12]
