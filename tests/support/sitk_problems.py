"""SimpleITK's cost and path, as an optimizer of ours sees them."""

import numpy as np
import SimpleITK as sitk

from regframe.transforms.warp import Warp
from support import sitk as peer


class SitkProblem:
    """A problem whose values and slopes SimpleITK computes, in its transforms' own parameters."""

    def __init__(self, method, fixed, moving, warp, scales):
        self.method, self.warp = method, warp
        self.fixed, self.moving = peer.image(fixed), peer.image(moving)
        self.pair = fixed, moving
        self.scales = np.array(scales, dtype=np.float64)
        self.weights = np.ones_like(self.scales)
        self.visited = []  # positions of values, and of slopes
        self.descended = []

    def at(self, params):
        return Warp(self.warp.transform, params, self.warp.frame)

    def values(self, batch):
        found = []
        for row in batch:
            self.visited.append(row.copy())
            self.method.SetInitialTransform(peer.transform(self.at(row)), True)
            found.append(self.method.MetricEvaluate(self.fixed, self.moving))
        return np.array(found)

    def value_and_gradient(self, at):
        value = float(self.values(at[None])[0])
        self.descended.append(at.copy())
        # A step this long leaves no trace of the position in its last bits.
        return value, peer.derivative(self.method, *self.pair, self.at(at), 1e8)

    def advance(self, at, step):
        return self.warp.transform.advance(at, step, self.warp.frame)

    def motion(self, at, step):
        """ITK's: a step whose largest component is 0.01, measured at the corners and scaled."""
        small = 0.01 / np.abs(step).max()
        corners = self.warp.frame.grid.corners()
        moved = self.at(self.advance(at, step * small))(corners) - self.at(at)(corners)
        return float(np.sqrt((moved**2).sum(axis=1)).max() / small)


def path(method, problem, start):
    """What SimpleITK tells at every iteration, and its final parameters.

    Returns a list of (position, value, convergence value, learning rate, scales), and the parameters.
    """
    told = []
    moved = peer.transform(problem.at(np.array(start, dtype=np.float64)))
    method.SetInitialTransform(moved, True)
    method.AddCommand(
        sitk.sitkIterationEvent,
        lambda: told.append(
            (
                method.GetOptimizerPosition(),
                method.GetMetricValue(),
                method.GetOptimizerConvergenceValue(),
                method.GetOptimizerLearningRate(),
                method.GetOptimizerScales(),
            )
        ),
    )
    method.Execute(problem.fixed, problem.moving)
    return told, np.array(moved.GetParameters())
