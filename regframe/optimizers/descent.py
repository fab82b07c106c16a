"""What the descents share: options, the meaning of scales, and the learning rate."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from regframe.optimizers.base import Problem
from regframe.types import Params

_ALIKE = 0.01
"""ITK takes scales that differ from 1 by no more than this for ones."""

_EVEN = 1e-4
"""ITK takes weights that differ from 1 by no more than this for ones."""

MaximumStep = Annotated[
    float,
    Field(
        gt=0,
        allow_inf_nan=False,
        description=(
            "Largest motion over the grid, in pixels (or mm), of a step whose learning rate is estimated. "
            "ITK's default is the spacing of the coarsest level's grid."
        ),
    ),
]
Keep = Annotated[
    Literal["best", "last"],
    Field(
        description=(
            "Which position to report: the best one measured, never worse than the start, at the price of "
            "one more evaluation a level; or the last one, as ITK does, which can be slightly worse."
        ),
    ),
]
LearningRate = Annotated[
    float,
    Field(
        gt=0,
        allow_inf_nan=False,
        description=(
            "Factor that makes a step of a slope: pixels (or mm) of motion for one metric unit per pixel, "
            "unless the stage has own scales. Not used where it is estimated."
        ),
    ),
]
ConvergenceMinimum = Annotated[
    float,
    Field(
        allow_inf_nan=False,
        description=(
            "Stop once the value falls by no more than this over `convergence_window` iterations, as a share "
            "of the sum of all values of the level; a negative number never stops a falling value."
        ),
    ),
]
ConvergenceWindow = Annotated[
    int, Field(ge=2, description="Number of iterations over which the fall of the value is judged.")
]


def effective(scales: Params) -> Params:
    """The scales as ITK uses them: ones where all are nearly one."""
    return np.ones_like(scales) if np.all(np.abs(scales - 1.0) <= _ALIKE) else scales


def factors(problem: Problem) -> Params:
    """What slopes are multiplied by, as in ITK: weights over scales, nothing where all are nearly 1."""
    weights, scales = problem.weights, problem.scales
    if np.all(np.abs(weights - 1.0) <= _EVEN):
        return np.asarray(1.0 / effective(scales))
    return np.asarray(weights / scales)


def learning_rate(problem: Problem, at: Params, move: Params, longest: float, *, otherwise: float) -> float:
    """Factor with which a move's largest motion over the grid is `longest`.

    Parameters
    ----------
    at, move : (p,) float64, coordinates
    longest : float, pixels (or mm)
    otherwise : float
        The answer for a move that moves nothing.
    """
    motion = problem.motion(at, move)
    return longest / motion if motion > np.finfo(np.float64).eps else otherwise


def dot(left: Params, right: Params) -> float:
    """The inner product, exactly summed."""
    return math.fsum(left * right)


def length(move: Params) -> float:
    """The Euclidean length of a move, in its own coordinates."""
    return math.sqrt(dot(move, move))
