from dataclasses import replace

import pytest

from regframe.engine.run import register
from regframe.preset import load
from regframe.verdict import backward
from regframe.verdict.evidence import round_trip

SEARCH = {
    "stages.0.start": {"type": "search", "scale": [0.5, 1.25], "fields_of_view_deg": [70.0, 90.0]},
    "filters.fixed": ["invert"],
    "filters.moving": [{"type": "percentile-clip"}],
}


def test_each_image_keeps_its_filters():
    there = load("paper-similarity", SEARCH)

    back = backward.turned(there)

    assert back.filters.fixed == there.filters.moving
    assert back.filters.moving == there.filters.fixed


def test_the_bounds_hold_for_the_inverse_map():
    start = backward.turned(load("paper-similarity", SEARCH)).stages[0].start

    assert start.scale == pytest.approx((0.8, 2.0))
    assert start.fields_of_view_deg == (90.0, 70.0)


def test_turned_twice_is_the_preset_but_for_the_places_that_go_on():
    there = load("paper-similarity", SEARCH)

    again = backward.turned(backward.turned(there))

    start, before = again.stages[0].start, there.stages[0].start
    assert all(1 <= fewer <= most for fewer, most in zip(start.keep, before.keep, strict=True))
    stage = again.stages[0].model_copy(update={"start": start.model_copy(update={"keep": before.keep})})
    assert again.model_copy(update={"stages": (stage, *again.stages[1:])}) == there


def test_the_last_of_three_levels_is_left_out():
    three, two = load("visual-thermal"), load("visual-thermal", {"stages.0.levels": [{"shrink": 2}, {}]})

    assert backward.turned(three).stages[0].levels == three.stages[0].levels[:-1]
    assert backward.turned(two).stages[0].levels == two.stages[0].levels


def test_only_a_search_is_a_second_opinion():
    assert backward.searches(load("paper-similarity", SEARCH))
    assert not backward.searches(load("paper-similarity"))


def test_a_search_back_confirms_a_street(street):
    result = register("visual-thermal", street.fixed, street.moving)

    back = backward.search(result)

    assert round_trip(result.warp, back, street.fixed.grid, street.moving.grid) < 1.0


def test_a_search_that_finds_nothing_is_none(street):
    result = register("visual-thermal", street.fixed, street.moving)
    never = {"type": "search", "scale": [0.01, 0.011], "overlap": 1.0, "shift": 0.0}
    hopeless = load("visual-thermal", {"stages.0.start": never})

    assert backward.search(replace(result, preset=hopeless)) is None
