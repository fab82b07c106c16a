"""A small card for notebooks: the pair before and after, and the facts beside it."""

from base64 import b64encode
from html import escape
from pathlib import PurePath

import numpy as np

from regframe.catalog import METRICS, TRANSFORMS
from regframe.engine.base import Result
from regframe.geometry import AffineMap, Grid
from regframe.report import records
from regframe.report.overlays import draw, red_cyan
from regframe.report.planes import planes
from regframe.report.png import Picture, encode
from regframe.report.starts import first_warp
from regframe.types import Params

WIDEST = 400
"""Pictures are thinned to about this many pixels across, so that notebooks stay small."""

_CELL = "padding:2px 10px 2px 0;text-align:left;vertical-align:top;border:0"


def card(result: Result) -> str:
    """A self-contained piece of HTML: overlays before and after, and a table of facts.

    Returns
    -------
    str
        A ``div`` with its pictures inline; it loads nothing and runs nothing.
    """
    before = draw(planes(result, first_warp(result)), red_cyan)
    after = draw(planes(result), red_cyan)
    pictures = _picture(before, "before") + _picture(after, "after")
    rows = "".join(
        f'<tr><th style="{_CELL};font-weight:600">{escape(name)}</th>'
        f'<td style="{_CELL}">{escape(text)}</td></tr>'
        for name, text in (("verdict", result.verdict.summary()), *facts(result))
    )
    legend = "fixed image red, moving image cyan; grey where both agree"
    return (
        '<div style="font-family:sans-serif;font-size:13px;line-height:1.4">'
        f'<div style="display:flex;flex-wrap:wrap;gap:12px">{pictures}</div>'
        f'<div style="opacity:0.7;margin:2px 0 8px">{legend}</div>'
        f'<table style="border-collapse:collapse;border:0">{rows}</table></div>'
    )


def facts(result: Result) -> list[tuple[str, str]]:
    """Name and text of what a user wants to know first."""
    metric = result.preset.stages[-1].metric
    first, last = result.levels[-1].start_value, result.levels[-1].value
    fixed, moving = (PurePath(image.name).name for image in (result.fixed, result.moving))
    return [
        ("preset", result.preset.name),
        ("images", f"{fixed} (fixed), {moving} (moving)"),
        ("map", describe(result)),
        *_choices(result),
        ("metric", f"{METRICS.name_of(metric)} {first:.5g} to {last:.5g} on the last level, lower is better"),
        ("stopped by", result.stop),
        ("effort", f"{result.evaluations} evaluations, {result.seconds:.2f} s"),
    ]


def _choices(result: Result) -> list[tuple[str, str]]:
    """What became of each stage that needed proof."""
    return [
        (
            f"stage {choice.stage + 1}",
            f"{TRANSFORMS.name_of(result.preset.stages[choice.stage].transform)} "
            f"{'kept' if choice.kept else 'not kept'}: {choice.reason}",
        )
        for choice in result.choices
    ]


def describe(result: Result) -> str:
    """The found map in a line: how far, how turned, how stretched, about the fixed image's centre.

    Angles are in degrees here, for people; files keep radians.
    """
    affine, bend = result.warp.as_affine(), ""
    if affine is None:
        affine, bend = _at_the_centre(result), f", {_bend(result)}"
    return f"{_plainly(result, affine)}{bend}"


def _plainly(result: Result, affine: AffineMap) -> str:
    """Shift, rotation, scale and shear of an affine map."""
    where = _shift(result, affine)
    flat = records.factors_about_centre(result, affine)
    if not flat:
        turn, stretches = _turn_and_stretches(affine)
        return f"{where}, rotation {np.rad2deg(turn):.3f} deg, scale {_from_to(stretches)}"
    words = f"{where}, rotation {np.rad2deg(flat['rotation_rad']):.3f} deg, "
    if abs(flat["scale_x"] - flat["scale_y"]) < 1e-9 and abs(flat["shear_x"]) < 1e-9:
        return f"{words}scale {flat['scale_x']:.5f}"
    return f"{words}scale ({flat['scale_x']:.5f}, {flat['scale_y']:.5f}), shear {flat['shear_x']:.5f}"


def _at_the_centre(result: Result) -> AffineMap:
    """The affine map nearest to a warp at the fixed image's centre, by differences of a pixel."""
    centre, width = result.fixed.grid.centre, min(result.fixed.grid.spacing)
    steps = width / 2 * np.eye(len(centre))
    matrix = (result.warp(centre + steps) - result.warp(centre - steps)).T / width
    return AffineMap(matrix, result.warp(centre[None])[0] - matrix @ centre)


def _bend(result: Result) -> str:
    """How far a map is from the affine one at its centre, where it leaves that most within both images."""
    fixed, moving = result.fixed.grid, result.moving.grid
    axes = np.meshgrid(*(np.linspace(0, n - 1, 9) for n in fixed.shape), indexing="ij")
    points = fixed.points(np.stack([axis.ravel() for axis in axes], axis=1))
    there = result.warp(points)
    met = moving.inside(moving.indices(there))
    away = np.linalg.norm(there - _at_the_centre(result)(points), axis=1)[met].max(initial=0.0)
    kind = "bent" if result.warp.as_homogeneous() is None else "in perspective"
    camera = moving == Grid.of_shape(moving.shape)
    return f"{kind} by up to {away:.2f} {'px' if camera else 'mm'}"


def _shift(result: Result, affine: AffineMap) -> str:
    """Where the fixed centre goes: from the moving centre for camera frames, else from where it was."""
    centre = result.fixed.grid.centre
    grids = (result.fixed.grid, result.moving.grid)
    camera = all(grid == Grid.of_shape(grid.shape) for grid in grids)
    lengths = affine(centre[None])[0] - (result.moving.grid.centre if camera else centre)
    words, unit = ("centre off by", "px") if camera else ("shift", "mm")
    return f"{words} ({', '.join(f'{one:.2f}' for one in lengths)}) {unit}"


def _turn_and_stretches(affine: AffineMap) -> tuple[float, Params]:
    """Angle of the nearest rotation (polar decomposition), and the principal stretches."""
    left, stretches, right = np.linalg.svd(affine.matrix)
    cosine = (np.trace(left @ right) - 1) / 2
    return float(np.arccos(np.clip(cosine, -1, 1))), stretches


def _from_to(stretches: Params) -> str:
    low, high = float(stretches.min()), float(stretches.max())
    return f"{low:.5f}" if high - low < 1e-9 else f"{low:.4f} to {high:.4f}"


def _picture(picture: Picture, caption: str) -> str:
    inline = b64encode(encode(_thinned(picture))).decode("ascii")
    return (
        f'<figure style="margin:0"><figcaption style="font-weight:600">{caption}</figcaption>'
        f'<img alt="overlay {caption} registration" src="data:image/png;base64,{inline}" '
        'style="max-width:100%;display:block"></figure>'
    )


def _thinned(picture: Picture) -> Picture:
    """Blocks of pixels averaged until the picture is narrow enough."""
    step = -(-picture.shape[1] // WIDEST)
    if step == 1 or picture.shape[0] < step:
        return picture
    height, width = (n // step for n in picture.shape[:2])
    blocks = picture[: height * step, : width * step].reshape(height, step, width, step, 3)
    return np.asarray(blocks.mean(axis=(1, 3)), np.uint8)
