import numpy as np
import pytest

from regframe.verdict import edges, matching
from regframe.verdict.edges import Edges


def noise(seed=1, shape=(90, 120)):
    rng = np.random.default_rng(seed)
    field = (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)).astype(np.complex64)
    return Edges(field, np.ones(shape, np.float32))


def rolled(one, down, across):
    return Edges(np.roll(one.field, (down, across), (0, 1)), one.weight)


def slow_surface(fixed, moving, reach):
    """The correlation, shift by shift."""
    below, above = fixed.centred(), moving.centred()
    fit = np.zeros((2 * reach + 1, 2 * reach + 1))
    rows, columns = below.shape
    for down in range(-reach, reach + 1):
        for across in range(-reach, reach + 1):
            here = (
                slice(max(0, -down), min(rows, rows - down)),
                slice(max(0, -across), min(columns, columns - across)),
            )
            there = tuple(
                slice(one.start + step, one.stop + step)
                for one, step in zip(here, (down, across), strict=True)
            )
            met = (np.conj(below[here]) * above[there]).real.sum()
            energy = (abs(below[here]) ** 2 * moving.weight[there]).sum() * (
                abs(above[there]) ** 2 * fixed.weight[here]
            ).sum()
            fit[down + reach, across + reach] = met / np.sqrt(energy)
    return fit


def test_the_surface_is_the_slow_one():
    fixed, moving = noise(1, (17, 23)), noise(2, (17, 23))
    fixed.weight[:4] = moving.weight[:, -5:] = 0.0
    fixed.field[:4] = moving.field[:, -5:] = 0.0

    fit, _ = matching.surface(fixed, moving, 6)

    assert np.allclose(fit, slow_surface(fixed, moving, 6), atol=1e-5)


def test_the_overlap_counts_the_pixels_that_meet():
    one = noise(shape=(20, 30))

    _, overlap = matching.surface(one, one, 5)

    assert overlap[5, 5] == 600
    assert overlap[5 + 2, 5 - 3] == 18 * 27


def test_edges_that_coincide_fit_wholly():
    one = noise()

    found = matching.peak(one, one)

    assert found.height == pytest.approx(1.0, abs=1e-5)
    assert found.rival < 0.1


def test_a_better_place_elsewhere_is_a_rival():
    one = noise()

    assert matching.peak(one, rolled(one, 0, 15)).rival > 5.0


def test_images_that_do_not_meet_have_no_peak():
    one = noise()
    nothing = Edges(np.zeros_like(one.field), np.zeros_like(one.weight))

    assert matching.peak(one, nothing) == matching.Peak(0.0, 0.0, float("inf"))


def test_every_part_finds_its_shift():
    one = noise()

    found = matching.tiles(one, rolled(one, 3, -2))

    assert len(found.weights) == 12
    assert np.allclose(found.shifts, (-2.0, 3.0), atol=0.2)
    assert found.typical() == pytest.approx(np.hypot(3, 2), abs=0.2)
    assert found.share_within(4.0) == 1.0
    assert found.share_within(3.0) == 0.0


def test_parts_that_the_moving_image_does_not_reach_are_left_out():
    one, half = noise(), noise()
    half.weight[:, :60] = half.field[:, :60] = 0.0

    assert {x > 60 for x, _ in matching.tiles(one, half).centres} == {True}


def test_tall_images_are_cut_more_often_down_than_across():
    one = noise(shape=(120, 90))

    assert len({y for _, y in matching.tiles(one, one).centres}) == 4


def test_images_too_small_for_parts_have_none():
    one = noise(shape=(12, 16))

    found = matching.tiles(one, one)

    assert len(found.weights) == 0
    assert found.share_within(5.0) == 0.0


def test_a_turned_map_leaves_larger_shifts_away_from_the_middle(street, beside):
    truth = street.truth
    _, below, above = edges.pair(
        street.fixed, street.moving, truth @ beside(angle_deg=3.0) @ beside().inverse()
    )

    found = matching.tiles(below, above)
    middle = (np.array(below.field.shape[::-1]) - 1) / 2
    away = np.linalg.norm(found.centres - middle, axis=1) > 80
    lengths = np.linalg.norm(found.shifts, axis=1)

    assert np.median(lengths[away]) > 1.5 * np.median(lengths[~away])
