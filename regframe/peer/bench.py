"""One level of a stage at its answer, ready to be asked by both sides."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from regframe.engine.followed import followed
from regframe.engine.objective import Objective
from regframe.engine.scales import Coordinates
from regframe.engine.scene import prepare
from regframe.engine.setting import Setting
from regframe.geometry import Grid
from regframe.image import Image
from regframe.peer import probe, twins
from regframe.peer.method import Part, seeds_used
from regframe.preset import Stage
from regframe.transforms.warp import Chain, Warp
from regframe.types import Params

MOST_SWEEPS = 12
"""Families of thousands of parameters are swept along a few of them, evenly chosen."""
REACH = 5.0
"""How far a sweep moves the image to either side, in pixels of the level's grid."""
POINTS = 11


@dataclass(frozen=True)
class Bench:
    """A stage's last level.

    Parameters
    ----------
    stage : Stage
    seed : int
        The sampling seed of the stage's first level.
    fixed, moving : Image
        After their filters, of one float type.
    warp : Warp
        The answer of the stage.
    setting : Setting
        What stays around it.
    """

    stage: Stage
    seed: int
    fixed: Image
    moving: Image
    warp: Warp
    setting: Setting

    @cached_property
    def last_seed(self) -> int:
        """The sampling seed of the last level."""
        return self.seed + sum(map(seeds_used, self.stage.levels[:-1]))

    @cached_property
    def objective(self) -> Objective:
        """Ours, of the parameters themselves, with slopes as ITK takes them."""
        stage = self.stage
        if stage.gradient == "exact":
            stage = stage.model_copy(update={"gradient": "filtered"})
        stage = stage.model_copy(update={"metric": twins.sloped(stage.metric)})
        stage = followed(stage, self.setting.beyond)
        scene, _ = prepare(stage, stage.levels[-1], self.fixed, self.moving, self.last_seed, self.setting)
        ones = np.ones_like(self.warp.params)
        return Objective(stage, scene, self.warp.frame, Coordinates(np.zeros_like(ones), ones, ones))

    @cached_property
    def part(self) -> Part:
        """The last level as SimpleITK is told it, for images that are smoothed already."""
        level = self.stage.levels[-1].model_copy(update={"smooth": 0.0})
        return Part(self.objective.stage, (level,), self.last_seed, self.setting)

    @cached_property
    def theirs(self) -> tuple[Image, Image]:
        """Both images as SimpleITK smooths them for the last level."""
        how = self.stage.levels[-1].smooth, self.stage.smooth_unit
        return probe.smoothed(self.fixed, *how), probe.smoothed(self.moving, *how)

    @cached_property
    def unit(self) -> Params:
        """Motion per unit of each parameter at the answer."""
        return self.objective.stage.transform.shift(self.warp.params, self.warp.frame)

    @property
    def grid(self) -> Grid:
        """The last level's grid."""
        return self.objective.scene.grid

    @property
    def single(self) -> bool:
        """Whether images are float32, and numbers made of them no more exact than that."""
        return self.fixed.rounds

    def at(self, params: Params) -> Warp:
        """The stage's map at other parameters."""
        return Warp(self.warp.transform, params, self.warp.frame)

    def onward(self, params: Params) -> Warp | Chain:
        """The whole way from the domain to the moving image at other parameters."""
        return self.setting.onward(self.at(params))

    def swept(self) -> Iterator[tuple[str, np.ndarray, list[Params]]]:
        """For some parameters: the name, motions in physical units, and positions through the answer."""
        transform, params, frame = self.warp.transform, self.warp.params, self.warp.frame
        names, unit = transform.names(frame), self.unit
        motions = np.linspace(-REACH, REACH, POINTS) * min(self.grid.spacing)
        chosen = np.unique(np.linspace(0, len(params) - 1, min(MOST_SWEEPS, len(params))).round().astype(int))
        for i in chosen:
            if unit[i] > 0:
                along = np.eye(len(params))[i]
                yield names[i], motions, [params + along * motion / unit[i] for motion in motions]
