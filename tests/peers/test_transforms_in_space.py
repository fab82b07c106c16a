"""Versors, their clipping, slopes and steps against SimpleITK's, by the parameters that it reaches."""

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.geometry import Frame, Grid
from regframe.transforms.rigid import Rigid
from regframe.transforms.scale import Scale
from regframe.transforms.scale_skew_versor import ScaleSkewVersor
from regframe.transforms.scale_versor import ScaleVersor
from regframe.transforms.similarity import Similarity
from regframe.transforms.versor import Versor
from regframe.transforms.versor_rigid import VersorRigid
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.objectives import objective

OBLIQUE = Grid(
    (12, 14, 16), (1.0, 1.1, 1.3), (4.0, -3.0, 8.0), ((0.6, -0.8, 0.0), (0.8, 0.6, 0.0), (0.0, 0.0, 1.0))
)
COMPOSING = [VersorRigid(), Similarity(), ScaleVersor(), ScaleSkewVersor()]
FAMILIES = [*COMPOSING, Versor(), Scale(), Rigid(), Rigid(order="zyx")]
by_name = pytest.mark.parametrize("family", COMPOSING, ids=lambda f: type(f).__name__)


def near(family, frame, size=0.1):
    """Parameters a little away from the identity, at which few samples fall off the moving image."""
    identity = family.identity(frame)
    return identity + np.random.default_rng(3).uniform(-size, size, len(identity))


@by_name
@pytest.mark.parametrize("length", [1.0 - 1e-11, 1.0, 1.7, 30.0])
def test_too_long_versors_are_clipped_the_same(family, length):
    frame = Frame(OBLIQUE, np.array([5.0, 6.0, -7.0]))
    params = near(family, frame)
    params[:3] = length * np.array([0.48, -0.6, 0.64])
    ours, theirs = Warp(family, params, frame), peer.transform(Warp(family, params, frame))
    points = np.random.default_rng(4).uniform(-50.0, 50.0, (20, 3))

    settled = family.advance(params, np.zeros_like(params), frame)

    assert np.array_equal(ours(points), [theirs.TransformPoint(point) for point in points.tolist()])
    np.testing.assert_allclose(settled, theirs.GetParameters(), rtol=0, atol=1e-15)


@pytest.mark.parametrize("family", FAMILIES, ids=repr)
@pytest.mark.parametrize("grid", [Grid.of_shape((12, 14, 16)), OBLIQUE], ids=["upright", "oblique"])
def test_a_step_along_the_slope_ends_at_the_same_parameters(family, grid):
    """Slopes by parameters and the way steps are added or composed, in one."""
    fixed, moving = peer.pair((12, 14, 16), np.float64, grid=grid)
    frame = Frame(grid, grid.centre + np.array([0.7, -0.4, 0.3]))
    warp = Warp(family, near(family, frame), frame)
    ours = objective(fixed, moving, warp, "linear", metric="mean-squares", gradient="central")
    slope = ours.value_and_gradient(warp.params)[1]
    rate = 0.4 / np.abs(slope).max()
    theirs = peer.method(fixed, moving, "linear")
    theirs.SetMetricAsMeanSquares()
    theirs.SetMetricUseMovingImageGradientFilter(False)

    found = ours.advance(warp.params, -rate * slope)

    moved = peer.transform(warp)
    theirs.SetOptimizerAsGradientDescent(rate, 1, -1e300, 100, theirs.Never)
    theirs.SetOptimizerScales([1.0] * len(slope))
    theirs.SetInitialTransform(moved, True)
    theirs.Execute(peer.image(fixed), peer.image(moving))
    # Samples on a border of the moving image are avoided by the odd centre; sums have 2688 terms.
    np.testing.assert_allclose(found, moved.GetParameters(), rtol=0, atol=1e-11)


@pytest.mark.parametrize("kind", ["physical-shift", "index-shift", "jacobian"])
@by_name
def test_scales_are_estimated_with_composed_steps(family, kind):
    from regframe.engine.scales import coordinates
    from regframe.preset import Stage

    fixed, moving = peer.pair((12, 14, 16), np.float64, grid=OBLIQUE)
    frame = Frame(OBLIQUE, OBLIQUE.centre)
    warp = Warp(family, near(family, frame), frame)
    stage = Stage(
        transform=family, interpolator="linear", metric="mattes", optimizer="one-plus-one", scales=kind
    )
    theirs, told = peer.method(fixed, moving, "linear"), []
    theirs.SetOptimizerAsGradientDescent(1e-12, 1, -1e300, 100, theirs.Never)
    {
        "physical-shift": theirs.SetOptimizerScalesFromPhysicalShift,
        "index-shift": theirs.SetOptimizerScalesFromIndexShift,
        "jacobian": theirs.SetOptimizerScalesFromJacobian,
    }[kind]()
    theirs.SetInitialTransform(peer.transform(warp), True)
    theirs.AddCommand(sitk.sitkIterationEvent, lambda: told.append(theirs.GetOptimizerScales()))
    theirs.Execute(peer.image(fixed), peer.image(moving))

    found, _ = coordinates(stage, warp.params, frame, OBLIQUE, OBLIQUE)

    np.testing.assert_allclose(found.scales, told[0], rtol=1e-9)
