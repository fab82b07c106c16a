"""Draw the pictures of the page on visual-thermal frames: before and after, and the search's landscape.

    python docs/visual_thermal.py

The frames are the built-in street, with the thermal camera turned and zoomed further than it comes.
"""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

mpl.use("Agg")
from matplotlib import pyplot as plt

import regframe
from regframe.engine.averaging import Pyramid
from regframe.engine.native import filtered
from regframe.engine.search import tried
from regframe.engine.setting import Setting
from regframe.io import coerce
from regframe.report.overlays import draw, red_cyan
from regframe.report.planes import planes
from regframe.testing.phantoms import visual_thermal
from regframe.transforms.linear import turn

IMAGES = Path(__file__).parent / "images"
TURNED_DEG, SCALED = 17.0, 1.05
CORNER = (48, 64)  # rows and columns left out on each side, so that the turned frame has no empty corner


def frames() -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """The visual frame, and the thermal one as a camera held otherwise would see it."""
    street = visual_thermal(seed=5)
    thermal = np.asarray(street.moving.values, np.float64)
    middle = (np.array(thermal.shape) - 1) / 2
    shape = tuple(n - 2 * c for n, c in zip(thermal.shape, CORNER, strict=True))
    matrix = turn(np.deg2rad(TURNED_DEG)) / SCALED
    offset = middle - matrix @ ((np.array(shape) - 1) / 2)
    seen = ndimage.affine_transform(thermal, matrix, offset, shape, order=1)
    return np.asarray(street.fixed.values, np.float32), seen.astype(np.float32)


def landscape(visual: NDArray[np.float32], thermal: NDArray[np.float32]) -> tuple[NDArray[np.float64], ...]:
    """Rotations (degrees), scales, and the best value at each pair of them."""
    preset = regframe.load_preset("visual-thermal")
    stage = preset.stages[0]
    pair = filtered(preset, coerce(visual, "visual"), coerce(thermal, "thermal"))
    best: dict[tuple[float, float], float] = {}
    for shift in tried(stage, Pyramid(*pair), Setting(pair[0].grid)):
        affine = shift.place().seen.as_affine()
        assert affine is not None
        angle = float(np.rad2deg(np.arctan2(affine.matrix[1, 0], affine.matrix[0, 0])))
        key = round(angle, 3), round(float(np.sqrt(np.linalg.det(affine.matrix))), 5)
        best[key] = min(best.get(key, 0.0), shift.value)
    angles, scales = (np.array(sorted(set(axis))) for axis in zip(*best, strict=True))
    values = np.array([[best.get((a, s), np.nan) for a in angles] for s in scales])
    return angles, scales * visual.shape[1] / thermal.shape[1], values


def main() -> None:
    """Write the two pictures."""
    visual, thermal = frames()
    result = regframe.register("visual-thermal", visual, thermal)
    before, after = (draw(planes(result, warp), red_cyan) for warp in (result.start, None))
    figure, axes = plt.subplots(1, 4, figsize=(14, 3.2), layout="constrained")
    shown = (visual, "visual"), (thermal, "thermal"), (before, "before"), (after, "after")
    for axis, (picture, title) in zip(axes, shown, strict=True):
        axis.imshow(picture, cmap="gray")
        axis.set_title(title)
        axis.set_axis_off()
    figure.savefig(IMAGES / "visual-thermal.jpg", dpi=110, pil_kwargs={"quality": 88})
    angles, scales, values = landscape(visual, thermal)
    figure, axis = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
    mesh = axis.pcolormesh(angles, scales, -values, cmap="viridis", shading="nearest")
    affine = result.warp.as_affine()
    assert affine is not None
    found = np.rad2deg(np.arctan2(affine.matrix[1, 0], affine.matrix[0, 0]))
    ratio = float(np.sqrt(np.linalg.det(affine.matrix))) * visual.shape[1] / thermal.shape[1]
    axis.plot(
        [found], [ratio], "o", mfc="none", mec="#D55E00", mew=2.5, ms=15, label="where the answer ended"
    )
    axis.set(xlabel="rotation, degrees", ylabel="scale, relative to equal fields of view", yscale="log")
    axis.set_yticks([0.6, 0.8, 1.0, 1.3, 1.7], ["0.6", "0.8", "1.0", "1.3", "1.7"])
    axis.minorticks_off()
    axis.legend(loc="upper left")
    figure.colorbar(mesh, label="correlation at the best of all shifts")
    figure.savefig(IMAGES / "search-landscape.png", dpi=100)


if __name__ == "__main__":
    main()
