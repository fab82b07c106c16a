"""A level's objective without an engine around it."""

import numpy as np

from regframe.catalog import INTERPOLATORS, METRICS
from regframe.engine.objective import Objective
from regframe.engine.scales import Coordinates
from regframe.engine.scene import prepare
from regframe.image import Image
from regframe.preset import Level, Stage
from regframe.transforms.warp import Warp
from support.sitk import WINDOWS

SPLINES = {f"bspline{order}": {"type": "bspline", "order": order} for order in range(1, 6)}
SINCS = {f"{window}-sinc": {"type": "windowed-sinc", "window": window} for window in WINDOWS}


def objective(
    fixed: Image,
    moving: Image,
    warp: Warp,
    interpolator: str,
    *,
    metric: object = "mattes",
    gradient: str = "exact",
) -> Objective:
    stage = Stage(
        transform=warp.transform,
        interpolator=INTERPOLATORS.build((SPLINES | SINCS).get(interpolator, interpolator)),
        metric=METRICS.build(metric),
        optimizer="one-plus-one",
        gradient=gradient,
    )
    scene, _ = prepare(stage, Level(), fixed, moving, 1)
    ones = np.ones_like(warp.params)
    return Objective(stage, scene, warp.frame, Coordinates(np.zeros_like(warp.params), ones, ones))
