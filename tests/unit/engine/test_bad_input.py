"""Pairs that cannot be registered, each refused in one clear sentence."""

import numpy as np
import pytest

import regframe
from regframe import GeometryError, ImageError, NoOverlapError, Warp
from regframe.catalog import TRANSFORMS
from regframe.image import Image
from support import sitk as peer


def preset(**changes):
    stage = {
        "transform": "translation",
        "interpolator": "linear",
        "metric": "mattes",
        "optimizer": "one-plus-one",
        "levels": [{"iterations": 3}],
        **changes,
    }
    return {"name": "test", "stages": [stage]}


def random(shape, seed=1):
    return np.random.default_rng(seed).uniform(0, 255, shape)


def test_a_constant_image_is_named():
    with pytest.raises(ImageError, match=r"moving: the image is constant, 7 everywhere"):
        regframe.register(preset(), random((20, 20)), np.full((20, 20), 7.0))


def test_a_constant_image_under_its_mask_is_named():
    flat = random((20, 20))
    flat[5:15, 5:15] = 3.0
    mask = np.zeros((20, 20), bool)
    mask[6:14, 6:14] = True

    with pytest.raises(ImageError, match=r"constant, 3 under its mask"):
        regframe.register(preset(), Image.of_array(flat).with_mask(mask), random((20, 20)))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_pixels_that_are_no_numbers_are_counted(bad):
    broken = random((20, 20))
    broken[3, 4:6] = bad

    with pytest.raises(ImageError, match=r"fixed: 2 of 400 pixels are NaN or infinite"):
        regframe.register(preset(), broken, random((20, 20)))


@pytest.mark.parametrize("shape", [(1, 1), (3, 40)])
def test_an_image_of_a_few_pixels_is_too_small(shape):
    with pytest.raises(ImageError, match=r"too small to register"):
        regframe.register(preset(), random(shape), random((20, 20)))


def test_planes_do_not_meet_volumes():
    with pytest.raises(GeometryError, match=r"fixed is 2-D and moving is 3-D"):
        regframe.register(preset(), random((20, 20)), random((8, 20, 20)))


def test_a_transform_for_volumes_refuses_planes():
    plane = random((10, 12))

    with pytest.raises(GeometryError, match=r"stages\.0\.transform: \w+ is for 3-D images\. Got 2-D"):
        regframe.register(preset(transform="versor-rigid"), plane, plane)


def test_images_that_do_not_meet_at_the_start():
    fixed, moving = peer.pair()
    family, frame = TRANSFORMS.build("translation"), peer.frame(fixed)

    with pytest.raises(NoOverlapError, match="share nothing to compare at the start"):
        regframe.register(preset(), fixed, moving, start=Warp(family, np.array([500.0, 0.0]), frame))


def test_a_descent_that_leaves_the_image_says_so():
    fixed, moving = peer.pair()
    far = {"type": "regular-step-gradient-descent", "learning_rate": 500.0}

    with pytest.raises(NoOverlapError, match="share nothing to compare on the way"):
        regframe.register(preset(optimizer=far), fixed, moving)


def test_an_evolution_refuses_children_that_leave_the_image():
    fixed, moving = peer.pair()
    wild = {"type": "one-plus-one", "radius": 300.0}

    result = regframe.register(preset(optimizer=wild, levels=[{"iterations": 40}]), fixed, moving)

    assert np.isfinite(result.value)


def test_masks_that_do_not_meet_share_nothing():
    fixed, moving = peer.pair()
    left = np.indices(fixed.grid.shape)[1] < 10

    with pytest.raises(NoOverlapError, match="Check the masks"):
        regframe.register(preset(), fixed.with_mask(left), moving.with_mask(~left & ~np.roll(left, 5, 1)))


def test_a_list_of_scales_of_the_wrong_length_is_refused():
    fixed, moving = peer.pair()

    with pytest.raises(regframe.PresetError, match=r"scales has 3 numbers and the transform 2 parameters"):
        regframe.register(preset(scales=[1.0, 1.0, 1.0]), fixed, moving)
