"""A transform whose every member is followed by one map that stays."""

from typing import final

import numpy as np
from pydantic import ConfigDict, SkipValidation

from regframe.geometry import AffineMap, Frame, Grid
from regframe.preset import Stage
from regframe.transforms.base import Transform
from regframe.transforms.warp import Chain, Warp
from regframe.types import Params, Points


@final
class Followed(Transform):
    """The members of a family, each followed by the same map; parameters are the family's.

    As in ITK's composite transform of which only the first part is optimised.
    """

    model_config = ConfigDict(arbitrary_types_allowed=True)

    inner: SkipValidation[Transform]
    beyond: SkipValidation[Warp | Chain]

    def identity(self, frame: Frame) -> Params:
        """The family's parameters that move nothing."""
        return self.inner.identity(frame)

    def names(self, frame: Frame) -> tuple[str, ...]:
        """The family's."""
        return self.inner.names(frame)

    def map(self, params: Params, points: Points, frame: Frame) -> Points:
        """Moving points of (n, dim) points, physical, x first."""
        return self.beyond(self.inner.map(params, points, frame))

    def parameter_gradient(self, params: Params, points: Points, forces: Points, frame: Frame) -> Params:
        """Sum over points of ``forces . d map / d params``, (p,)."""
        pulled = self.beyond.pull(self.inner.map(params, points, frame), forces)
        return self.inner.parameter_gradient(params, points, pulled, frame)

    def shift(self, params: Params, frame: Frame) -> Params:
        """Largest motion per unit of each parameter, (p,), behind the whole way.

        A family with a rule of its own, such as one with a support for each parameter, keeps it; its motion
        is then multiplied by the most that the following map stretches.
        """
        if type(self.inner).shift is Transform.shift:
            return Transform.shift(self, params, frame)
        affine = self.beyond.as_affine()
        stretch = 1.0 if affine is None else float(np.linalg.norm(affine.matrix, 2))
        return self.inner.shift(params, frame) * stretch

    def advance(self, params: Params, step: Params, frame: Frame) -> Params:
        """The family's way of taking a step."""
        return self.inner.advance(params, step, frame)

    def adapted(self, params: Params, frame: Frame, grid: Grid, refine: int | None) -> tuple[Params, Frame]:
        """The family's way of preparing for a level."""
        return self.inner.adapted(params, frame, grid, refine)

    def as_affine(self, params: Params, frame: Frame) -> AffineMap | None:
        """The whole way as a matrix and offset, or None."""
        inner, beyond = self.inner.as_affine(params, frame), self.beyond.as_affine()
        return None if inner is None or beyond is None else beyond @ inner


def followed(stage: Stage, beyond: Warp | Chain | None) -> Stage:
    """The stage whose maps are followed by another one, where there is one."""
    if beyond is None:
        return stage
    return stage.model_copy(update={"transform": Followed(inner=stage.transform, beyond=beyond)})


def alone(transform: Transform) -> Transform:
    """The family itself, without what follows it."""
    return transform.inner if isinstance(transform, Followed) else transform
