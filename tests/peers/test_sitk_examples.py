"""The presets of SimpleITK's examples walk as the examples do."""

import numpy as np
import pytest

from regframe.engine.run import register
from regframe.preset import load
from support import sitk as peer
from support.runs import both


def shifted(dtype=np.float64):
    """A pair that is off by two pixels and one."""
    fixed, _ = peer.pair((48, 60), dtype)
    return fixed, fixed.with_values(np.roll(fixed.values, (2, -1), axis=(0, 1)))


# Few steps: near the optimum ITK's step turns back on the sign of a slope that is nearly 0.
@pytest.mark.parametrize("number", [1, 3, 4])
def test_walks_as_the_example_does(number):
    fixed, moving = shifted()
    chosen = load(f"sitk-example-{number}", {"stages.0.levels.0.iterations": 4})

    ours, theirs = both(chosen, fixed, moving)

    assert theirs.provenance["notes"] == []
    walked, values = (
        [[getattr(step, name) for step in result.trace] for result in (ours, theirs)]
        for name in ("params", "value")
    )
    np.testing.assert_allclose(*walked, rtol=0, atol=1e-9)
    np.testing.assert_allclose(*values, rtol=1e-9)


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_finds_the_shift(number):
    fixed, moving = shifted()

    found = register(f"sitk-example-{number}", fixed, moving)

    # The wrapped rim and, in the fourth, a tenth of the pixels leave some tenths of a pixel.
    corners = fixed.grid.corners()
    assert np.linalg.norm(found.warp(corners) - (corners + np.array([-1.0, 2.0])), axis=1).mean() < 0.5
