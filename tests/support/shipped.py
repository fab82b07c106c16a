"""What both engines can make of each shipped preset, and which presets are compared how far."""

import numpy as np

from house.source import REPOSITORY
from regframe import preset as presets
from regframe.geometry import Frame, Grid
from regframe.optimizers.amoeba import Amoeba
from regframe.optimizers.exhaustive import Exhaustive
from regframe.optimizers.one_plus_one import OnePlusOne
from regframe.optimizers.powell import Powell
from regframe.preset import Preset, Stage

NAMES = sorted(path.stem for path in (REPOSITORY / "presets").glob("*.toml"))

NATIVE_ONLY = dict.fromkeys(
    (
        "multimodal-brain-2d",
        "visual-thermal",
        "visual-thermal-affine",
        "visual-thermal-fast",
        "visual-thermal-projective",
        "visual-thermal-radial",
    ),
    "SimpleITK has no search, no BFGS and no metric of oriented gradients",
)
"""Presets that SimpleITK cannot run, and why: it must refuse exactly these."""

OWN_WAYS = {
    "dipy-affine": "SimpleITK's L-BFGS-B is an older version on other slopes",
    "sitk-bspline-1": "SimpleITK's L-BFGS-B is an older version on other slopes",
    "sitk-exhaustive": "SimpleITK tells every position, regframe the best so far; answers are compared",
    "sitk-exhaustive-3d": "SimpleITK tells every position, regframe the best so far; answers are compared",
}
"""Presets that both engines run on different ways, and why: exactly these must say so."""

FOR_VOLUMES = {"brain-affine", "brain-ct-mr", "brain-rigid"}
"""Presets whose shares of points are for volumes: of a slice they would draw some hundred pixels."""

VALUES_ALONE = (OnePlusOne, Powell, Amoeba, Exhaustive)
"""Optimizers that take no slopes: they decide by values, which agree to the last bits."""


def dimensions(chosen: Preset) -> list[int]:
    """The sizes of images that a preset can be run on: its transforms', and its lists' lengths."""
    sizes = (3,) if chosen.name in FOR_VOLUMES else (2, 3)
    return [dim for dim in sizes if all(_fits(stage, dim) for stage in chosen.stages)]


def _fits(stage: Stage, dim: int) -> bool:
    if dim not in stage.transform.dimensions:
        return False
    count = len(stage.transform.identity(Frame.about_centre(Grid.of_shape((16,) * dim))))
    steps = stage.optimizer.number_of_steps if isinstance(stage.optimizer, Exhaustive) else (1,)
    lists = [numbers for numbers in (stage.scales, stage.weights) if isinstance(numbers, tuple)]
    lists += [steps] if len(steps) > 1 else []
    return all(len(numbers) == count for numbers in lists)


def without_slopes(chosen: Preset) -> bool:
    """Whether all optimizers of a preset decide by values."""
    return all(isinstance(stage.optimizer, VALUES_ALONE) for stage in chosen.stages)


def shortened(name: str, iterations: float, share: float = 0.0) -> Preset:
    """A shipped preset with at most so many iterations a level, and at least a share of the points.

    A lattice is visited whole.
    """
    whole = presets.load(name)
    stages = []
    for stage in whole.stages:
        most = np.inf if isinstance(stage.optimizer, Exhaustive) else iterations
        levels = [
            level.model_copy(
                update={
                    "iterations": int(min(level.iterations, most)),
                    "fraction": max(level.fraction, share),
                }
            )
            for level in stage.levels
        ]
        stages.append(stage.model_copy(update={"levels": tuple(levels)}))
    return whole.model_copy(update={"stages": tuple(stages)})
