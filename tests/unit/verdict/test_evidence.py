from dataclasses import replace

import numpy as np
import pytest

from regframe.engine.overlap import overlap
from regframe.geometry import Frame, Grid
from regframe.transforms.affine import Affine
from regframe.transforms.warp import Warp
from regframe.verdict.evidence import gather, round_trip


@pytest.fixture(scope="module")
def right(street):
    return gather(street.fixed, street.moving, street.truth, round_trip_px=0.0)


@pytest.fixture(scope="module")
def wrong(street, beside):
    there = beside(angle_deg=-12.0, scale=1.2, shift_px=(30.0, 5.0))
    return gather(street.fixed, street.moving, there, round_trip_px=None)


def test_at_the_truth_every_part_lies_where_it_should(right):
    assert right.parts == 12
    assert right.parts_near > 0.9
    assert right.leftover_px < 0.5
    assert right.rival < 0.6


def test_at_a_wrong_map_the_parts_scatter(wrong):
    assert wrong.parts_near < 0.4
    assert wrong.leftover_px > 5.0
    assert wrong.rival > 0.8
    assert wrong.round_trip_px is None


@pytest.mark.parametrize("distance", [3.0, 6.0, 10.0])
def test_the_leftover_is_the_distance_from_the_truth(street, beside, distance):
    there = beside(shift_px=(0.6 * distance, -0.8 * distance)) @ beside().inverse() @ street.truth

    found = gather(street.fixed, street.moving, there, round_trip_px=None)

    assert found.leftover_px == pytest.approx(distance, abs=1.0)


def test_inverted_contrast_is_the_same_evidence(street, right):
    inverted = street.moving.with_rounded(-street.moving.values)

    found = gather(street.fixed, inverted, street.truth, round_trip_px=0.0)

    assert found.parts_near == pytest.approx(right.parts_near, abs=0.01)
    assert found.edge_fit == pytest.approx(right.edge_fit, abs=0.01)


def test_images_that_do_not_meet_say_nothing_good(street, beside):
    found = gather(street.fixed, street.moving, beside(shift_px=(9000.0, 0.0)), round_trip_px=None)

    assert (found.parts, found.parts_near, found.edge_fit, found.overlap) == (0, 0.0, 0.0, 0.0)
    assert found.leftover_px == float("inf")


def test_a_way_back_that_is_the_inverse_makes_no_round_trip(street):
    grids = street.fixed.grid, street.moving.grid

    assert round_trip(street.truth, street.truth.inverse(), *grids) == pytest.approx(0.0, abs=1e-9)


def test_the_round_trip_is_in_moving_pixels(beside, street):
    grids = street.fixed.grid, street.moving.grid
    there = beside(shift_px=(3.0, 4.0))

    assert round_trip(there, beside().inverse(), *grids) == pytest.approx(5.0)


def test_without_a_way_back_the_round_trip_is_endless(street):
    assert round_trip(street.truth, None, street.fixed.grid, street.moving.grid) == float("inf")


def test_without_a_meeting_the_round_trip_is_endless(street, beside):
    there = beside(shift_px=(9000.0, 0.0))

    assert round_trip(there, there.inverse(), street.fixed.grid, street.moving.grid) == float("inf")


def test_points_that_a_map_throws_to_infinity_are_left_out(street):
    grid = street.fixed.grid
    lost = Warp(Affine(), np.full(6, np.nan), Frame.about_centre(grid))

    assert round_trip(lost, street.truth.inverse(), grid, street.moving.grid) == float("inf")


def test_overlap_is_of_the_smaller_field_of_view(beside, street):
    grids = street.fixed.grid, street.moving.grid

    assert overlap(beside(), *grids) == pytest.approx(1.0)
    assert overlap(beside(scale=0.5), *grids) == pytest.approx(1.0)
    assert overlap(beside(scale=2.0), *grids) == pytest.approx(1.0)
    assert overlap(beside(shift_px=(0.5 * grids[1].shape[1], 0.0)), *grids) == pytest.approx(0.5, abs=0.06)


def test_pixels_count_whatever_their_size(street, right):
    def finer(image):
        grid = Grid(image.grid.shape, (0.1, 0.1), (0.0, 0.0), image.grid.direction)
        return replace(image, grid=grid)

    fixed, moving = finer(street.fixed), finer(street.moving)
    truth = street.truth.as_affine()
    scaled = Warp.of_affine(replace(truth, offset=0.1 * truth.offset), Frame.about_centre(fixed.grid))

    found = gather(fixed, moving, scaled, round_trip_px=0.0)

    assert found.leftover_px == pytest.approx(right.leftover_px, abs=0.05)
    assert found.parts_near == pytest.approx(right.parts_near, abs=0.01)
