"""Whole runs of every shipped preset by both engines, compared at the fixed image's corners."""

import pytest

from regframe import preset as presets
from regframe.engine.native import Native
from regframe.errors import GeometryError, NoTwin
from regframe.optimizers.one_plus_one import OnePlusOne
from regframe.peer.simpleitk import SimpleITKEngine, told_preset
from regframe.peer.whole import apart, finished
from regframe.testing.phantoms import visual_thermal
from support import sitk as peer

ITERATIONS = 25  # a level, so that every preset is walked through in seconds


def shortened(name):
    """A preset with fewer iterations, and the sizes of images that it is for."""
    whole = presets.load(name)
    stages = []
    for stage in whole.stages:
        levels = [
            level.model_copy(update={"iterations": min(level.iterations, ITERATIONS)})
            for level in stage.levels
        ]
        stages.append(stage.model_copy(update={"levels": tuple(levels)}))
    return whole.model_copy(update={"stages": tuple(stages)})


def images(chosen):
    """A visual and a thermal frame, or volumes where the preset's transforms are for those alone."""
    if all(2 in stage.transform.dimensions for stage in chosen.stages):
        # Large enough that no child of a coarse level throws the frame away, which ends ITK's runs.
        street = visual_thermal(seed=1, shape=(96, 128))
        return street.fixed, street.moving
    return peer.pair((20, 24, 28))


@pytest.mark.parametrize("name", presets.names())
def test_both_engines_end_at_the_same_map(name):
    chosen = shortened(name)
    fixed, moving = images(chosen)
    try:
        theirs = finished(SimpleITKEngine(), chosen, (fixed, moving))
    except (NoTwin, GeometryError) as error:
        pytest.skip(f"SimpleITK cannot run it: {error}")

    ours = finished(Native(), told_preset(chosen, theirs.provenance), (fixed, moving))

    if not theirs.provenance["alike"]:
        pytest.skip(f"both walk differently: {theirs.provenance['notes']}")
    evolves = all(isinstance(stage.optimizer, OnePlusOne) for stage in chosen.stages)
    # Slopes differ in their last bits, and every turn of a descent depends on the sign of one.
    assert apart(ours.warp, theirs.warp) <= (1e-6 if evolves else 1e-4)
    assert abs(len(ours.trace) - len(theirs.trace)) <= len(ours.levels)


@pytest.mark.parametrize("name", ["paper-similarity", "paper-affine"])
def test_the_preset_as_written_takes_the_same_way(name):
    """One level of evolution in pixels of motion is ITK's walk, said in other units."""
    chosen = shortened(name)
    pair = images(chosen)

    ours, theirs = (finished(engine, chosen, pair) for engine in (Native(), SimpleITKEngine()))

    assert apart(ours.warp, theirs.warp) <= 1e-6
