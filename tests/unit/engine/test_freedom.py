"""Parameters that a search may not change."""

import numpy as np
import pytest

from regframe import PresetError, register
from regframe.catalog import OPTIMIZERS
from regframe.preset import parse
from support import sitk as peer

STAGE = {"transform": "similarity", "interpolator": "linear", "metric": "mean-squares"}
QUICK = [{"shrink": 2, "smooth": 1.0, "iterations": 6}]


def preset(**changes):
    return parse({"stages": [{**STAGE, "optimizer": "one-plus-one", "levels": QUICK, **changes}]})


@pytest.mark.parametrize("optimizer", OPTIMIZERS.names())
def test_every_optimizer_keeps_frozen_parameters_to_the_bit(optimizer):
    fixed, moving = peer.pair((30, 36), np.float64)

    result = register(preset(optimizer=optimizer, frozen=["scale", "angle_rad"]), fixed, moving)

    assert tuple(result.warp.params[:2]) == (1.0, 0.0)
    assert np.any(result.warp.params[2:] != 0.0)
    assert all(tuple(step.params[:2]) == (1.0, 0.0) for step in result.trace)


def test_a_search_of_fewer_parameters_is_that_of_the_smaller_family():
    fixed, moving = peer.pair((30, 36), np.float64)

    frozen = register(preset(frozen=["scale", "angle_rad"]), fixed, moving)
    smaller = register(preset(transform="translation"), fixed, moving)

    # Motion per unit is measured by differences, whose last digits depend on the family.
    np.testing.assert_allclose(frozen.warp.params[2:], smaller.warp.params, rtol=0, atol=1e-9)


def test_a_name_that_no_parameter_has_is_told():
    fixed, moving = peer.pair((30, 36))

    with pytest.raises(PresetError, match=r"called 'angle'.*angle_rad"):
        register(preset(frozen=["angle"]), fixed, moving)


def test_weights_of_another_number_are_told():
    fixed, moving = peer.pair((30, 36))

    with pytest.raises(PresetError, match=r"weights has 2 numbers and the transform 4"):
        register(preset(optimizer="gradient-descent", weights=[1.0, 0.0]), fixed, moving)


def test_freezing_everything_is_refused():
    fixed, moving = peer.pair((30, 36))

    with pytest.raises(PresetError, match="nothing to search"):
        register(preset(frozen=["scale", "angle_rad", "tx", "ty"]), fixed, moving)


def test_weights_need_an_optimizer_that_follows_slopes():
    with pytest.raises(PresetError, match=r"stages\.0\.weights: the optimizer 'one-plus-one' does not walk"):
        preset(weights=[1.0, 0.0, 1.0, 1.0])


def test_a_frozen_parameter_may_move_nothing():
    fixed, moving = peer.pair((30, 36))
    fixed = fixed.with_values(fixed.values)

    result = register(
        preset(transform={"type": "bspline", "mesh": [1]}, frozen=["x[0,0]"], optimizer="gradient-descent"),
        fixed,
        moving,
    )

    assert result.warp.params[0] == 0.0
