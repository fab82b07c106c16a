"""Wallace's generator against SimpleITK's, read from the path of a search in many dimensions."""

import numpy as np
import SimpleITK as sitk

from regframe.kernels.variates import Wallace

ITERATIONS = 40


def test_deviates_are_simpleitks_across_pass_borders():
    """Every success shows a whole row of deviates: 242 parameters x 40 iterations cross nine borders."""
    y, x = np.mgrid[:24, :24]
    fixed = sitk.GetImageFromArray(np.sin(x / 3.0) + np.cos(y / 4.0))
    moving = sitk.GetImageFromArray(np.sin((x + 2) / 3.0) + np.cos(y / 4.0))
    spline = sitk.BSplineTransformInitializer(fixed, [8, 8])
    method = sitk.ImageRegistrationMethod()
    method.SetMetricAsMeanSquares()
    # Growth and shrinkage so near 1 that the search matrix stays the radius to 1e-12.
    method.SetOptimizerAsOnePlusOneEvolutionary(ITERATIONS, 1e-12, 1e-3, 1.0 + 1e-13, 1.0 - 1e-13, 77)
    method.SetInitialTransform(spline, True)
    told = []
    method.AddCommand(sitk.sitkIterationEvent, lambda: told.append(np.array(method.GetOptimizerPosition())))

    method.Execute(fixed, moving)

    drawn = Wallace(77).standard_normal(ITERATIONS * 242).reshape(ITERATIONS, 242)
    moves = np.diff(np.stack([np.zeros(242), *told]), axis=0)
    successes = np.flatnonzero(np.abs(moves).max(axis=1) > 0)
    assert successes[0] < 5
    assert successes[-1] > 30
    # Positions of up to 0.02 lose 1e-18 of moves of 1e-3.
    np.testing.assert_allclose(moves[successes] / 1e-3, drawn[successes], rtol=1e-10, atol=1e-13)
