"""What a result says in words and numbers: the transform, the run, its trace."""

import json
import re
from collections.abc import Iterator, Mapping
from math import isfinite
from typing import Any

from regframe.catalog import TRANSFORMS
from regframe.engine.base import Result
from regframe.geometry import AffineMap, Frame, Grid
from regframe.preset import dump
from regframe.transforms.affine import factors
from regframe.transforms.linear import translation_about
from regframe.transforms.warp import Chain, Warp

CONVENTION = {
    "direction": (
        "Every map takes a position in the fixed image to the matching position in the moving image, "
        "unless its name says moving_to_fixed."
    ),
    "pixels": (
        "x runs along a row, y down the columns (z through the slices). The centre of the first pixel "
        "is 0; pixel centres are whole numbers."
    ),
    "physical": (
        "origin + direction @ (spacing * pixel), x first; mm for medical images, pixels for camera images."
    ),
    "matrices": "Homogeneous, row by row: [x', y', 1] = matrix @ [x, y, 1], one axis more in 3-D.",
    "resampling": (
        "The aligned image takes, at each fixed pixel, the moving image's value at fixed_to_moving_px of it. "
        "In OpenCV: cv2.warpAffine(moving, numpy.array(fixed_to_moving_px)[:2], fixed_size, "
        "flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP)."
    ),
    "parameters": (
        "ITK's, in ITK's order: y = M (x - centre) + centre + t, physical. Angles are radians, from x "
        "towards y."
    ),
    "factors": (
        "The whole map about the fixed image's centre: M = R(rotation) @ [[1, shear_x], [shear_y, 1]] @ "
        "diag(scale_x, scale_y), then the translation t."
    ),
    "warps": "Applied from the last one listed to the first, as in ITK's composite transform.",
}


def transform_record(result: Result) -> dict[str, Any]:
    """What ``transform.json`` holds: matrices both ways, parameters by name, the convention in words."""
    warp = result.warp
    members = warp.warps if isinstance(warp, Chain) else (warp,)
    return {
        "convention": CONVENTION,
        **_matrices(result, warp.as_affine()),
        "warps": [_member(one) for one in members],
        "fixed": {"name": result.fixed.name, **_lattice(result.fixed.grid)},
        "moving": {"name": result.moving.name, **_lattice(result.moving.grid)},
    }


def result_record(result: Result, *, verdict: bool = True) -> dict[str, Any]:
    """What ``result.json`` holds: verdict, outcome, levels, resolved preset, and where it came from.

    Parameters
    ----------
    result : Result
    verdict : bool
        Off, the verdict is not asked for, and null.
    """
    return {
        "verdict": result.verdict.record() if verdict else None,
        "value": result.value,
        "stop": result.stop,
        "seconds": sum(level.seconds for level in result.levels),
        "iterations": sum(level.iterations for level in result.levels),
        "evaluations": sum(level.evaluations for level in result.levels),
        "levels": [_level(result, index) for index in range(len(result.levels))],
        "preset": dump(result.preset),
        "provenance": dict(result.provenance),
    }


def trace_rows(result: Result) -> Iterator[list[str]]:
    """Rows of ``trace.csv``, the head first: one line an iteration, a column a parameter."""
    tables = [parameter_names(result, stage) for stage in range(len(result.preset.stages))]
    columns = list(dict.fromkeys(name for table in tables for name in table))
    yield ["stage", "level", "iteration", "evaluations", "value", "size", *columns, "seconds"]
    for step in result.trace:
        known = dict(zip(tables[step.stage], step.params, strict=True))
        counts = (step.stage, step.level, step.iteration, step.evaluations)
        params = (repr(float(known[name])) if name in known else "" for name in columns)
        measured = (repr(float(step.value)), repr(float(step.size)))
        yield [*map(str, counts), *measured, *params, f"{step.seconds:.6f}"]


def to_json(record: Mapping[str, Any]) -> str:
    """A record as indented JSON; numbers that JSON cannot hold become null.

    Examples
    --------
    >>> print(to_json({"value": float("inf")}))
    {
      "value": null
    }
    """
    text = json.dumps(_finite(record), indent=2, allow_nan=False, default=str)
    # Rows of a matrix read better on a line each.
    return re.sub(r"\[\n([^\[\]{}]+)\n *\]", lambda row: f"[{' '.join(row[1].split())}]", text)


def parameter_names(result: Result, stage: int) -> tuple[str, ...]:
    """What the parameters of a stage are called."""
    return result.preset.stages[stage].transform.names(Frame.about_centre(result.fixed.grid))


def named_factors(result: Result) -> dict[str, float]:
    """Translation, rotation, scales and shears of a 2-D map about the fixed image's centre; empty in 3-D."""
    affine = result.warp.as_affine()
    if affine is None or affine.dim != 2:
        return {}
    return factors(affine.matrix, translation_about(affine, result.fixed.grid.centre))


def _matrices(result: Result, affine: AffineMap | None) -> dict[str, Any]:
    if affine is None:
        return {}
    pixels = result.pixel_map
    found: dict[str, Any] = {
        "fixed_to_moving_px": pixels.homogeneous().tolist(),
        "moving_to_fixed_px": pixels.inverse().homogeneous().tolist(),
        "fixed_to_moving_physical": affine.homogeneous().tolist(),
        "moving_to_fixed_physical": affine.inverse().homogeneous().tolist(),
    }
    if affine.dim == 2:
        found["factors"] = named_factors(result)
    return found


def _member(warp: Warp) -> dict[str, Any]:
    names = warp.transform.names(warp.frame)
    return {
        "type": TRANSFORMS.name_of(warp.transform),
        "centre": list(map(float, warp.frame.centre)),
        "parameters": dict(zip(names, map(float, warp.params), strict=True)),
    }


def _lattice(grid: Grid) -> dict[str, Any]:
    return {
        "size": list(reversed(grid.shape)),
        "spacing": list(grid.spacing),
        "origin": list(grid.origin),
        "direction": [list(row) for row in grid.direction],
    }


def _level(result: Result, index: int) -> dict[str, Any]:
    level = result.levels[index]
    names = parameter_names(result, level.stage)
    return {
        "stage": level.stage,
        "level": level.level,
        "size": list(reversed(level.shape)),
        "samples": level.samples,
        "iterations": level.iterations,
        "evaluations": level.evaluations,
        "start_value": level.start_value,
        "value": level.value,
        "stop": level.stop,
        "seconds": level.seconds,
        "parameters": dict(zip(names, level.params, strict=True)),
    }


def _finite(tree: object) -> object:
    if isinstance(tree, Mapping):
        return {str(key): _finite(value) for key, value in tree.items()}
    if isinstance(tree, list | tuple):
        return [_finite(value) for value in tree]
    return None if isinstance(tree, float) and not isfinite(tree) else tree
