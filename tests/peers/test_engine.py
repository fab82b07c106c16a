"""Whole runs of every shipped preset by both engines, compared at the fixed image's corners."""

import pytest

from regframe.engine.native import Native
from regframe.errors import NoTwin
from regframe.peer.simpleitk import SimpleITKEngine, told_preset
from regframe.peer.whole import apart, finished
from regframe.testing.phantoms import visual_thermal
from support import sitk as peer
from support.shipped import NAMES, NATIVE_ONLY, OWN_WAYS, dimensions, shortened, without_slopes

# A level, so that every preset is walked through in seconds. `tests/realdata/test_parity.py` walks farther.
ITERATIONS = 5
SHARE = 0.3  # of the points of these small images; a hundredth of them would be a handful


def images(chosen):
    """A visual and a thermal frame, or volumes where the preset is for those alone."""
    if 2 in dimensions(chosen):
        # Large enough that no child of a coarse level throws the frame away, which ends ITK's runs.
        street = visual_thermal(seed=1, shape=(96, 128))
        return street.fixed, street.moving
    return peer.pair((20, 24, 28))


@pytest.mark.parametrize("name", sorted(set(NAMES) - set(NATIVE_ONLY)))
def test_both_engines_end_at_the_same_map(name):
    chosen = shortened(name, 1 if name in OWN_WAYS else ITERATIONS, SHARE)
    fixed, moving = images(chosen)
    theirs = finished(SimpleITKEngine(), chosen, (fixed, moving))

    ours = finished(Native(), told_preset(chosen, theirs.provenance), (fixed, moving))

    # A preset that no longer compares, or one that is listed and does, fails here.
    assert theirs.provenance["alike"] == (name not in OWN_WAYS), theirs.provenance["notes"]
    if theirs.provenance["alike"]:
        # Slopes differ in their last bits, with the order in which SimpleITK's threads end too, and every
        # turn of a descent depends on the sign of one. One thread: tests/realdata/test_parity.py.
        assert apart(ours.warp, theirs.warp) <= (1e-6 if without_slopes(chosen) else 1e-3)
        assert abs(len(ours.trace) - len(theirs.trace)) <= len(ours.levels)


def test_simpleitk_refuses_what_is_listed():
    for name in NATIVE_ONLY:
        chosen = shortened(name, 1, SHARE)
        with pytest.raises(NoTwin):
            finished(SimpleITKEngine(), chosen, images(chosen))


def test_lists_name_presets_that_exist():
    assert {*NATIVE_ONLY, *OWN_WAYS} <= set(NAMES)
    assert not set(NATIVE_ONLY) & set(OWN_WAYS)


@pytest.mark.parametrize("name", ["paper-similarity", "paper-affine"])
def test_the_preset_as_written_takes_the_same_way(name):
    """One level of evolution in pixels of motion is ITK's walk, said in other units."""
    chosen = shortened(name, ITERATIONS, SHARE)
    pair = images(chosen)

    ours, theirs = (finished(engine, chosen, pair) for engine in (Native(), SimpleITKEngine()))

    assert apart(ours.warp, theirs.warp) <= 1e-6
