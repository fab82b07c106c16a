"""What a result says in words and numbers: the transform, the run, its trace."""

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from math import isfinite
from typing import Any

from regframe.engine.base import LevelReport, Result, unit_depth
from regframe.engine.candidate import Candidate
from regframe.geometry import AffineMap
from regframe.preset import dump
from regframe.transforms.affine import factors
from regframe.transforms.homography import inverted
from regframe.transforms.json_files import lattice, record
from regframe.transforms.linear import translation_about
from regframe.transforms.warp import Chain

MOST_COLUMNS = 1000
"""Parameters that tables list one by one."""
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
    "matrices": (
        "Homogeneous, row by row: [x', y', 1] = matrix @ [x, y, 1], one axis more in 3-D. Of a homography, "
        "divide x' and y' by the third component; where that is 0 or less there is no image."
    ),
    "resampling": (
        "The aligned image takes, at each fixed pixel, the moving image's value at fixed_to_moving_px of it. "
        "In OpenCV: cv2.warpAffine(moving, numpy.array(fixed_to_moving_px)[:2], fixed_size, "
        "flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP); of a homography cv2.warpPerspective and the whole "
        "matrix. A map that bends straight lines has no matrix: regframe apply takes this file."
    ),
    "parameters": (
        "ITK's, in ITK's order: y = M (x - centre) + centre + t, physical. Angles are radians, from x "
        "towards y. Of `projective`, which ITK lacks: y = M (x - centre) / (1 + p . (x - centre) / r) + "
        "centre + t, r half the diagonal of the fixed image. Of `projective-radial`: the same between ideal "
        "images, each of which is middle + (seen - middle) / (1 + k1 q^2 + k2 q^4), q the distance from the "
        "image's middle in half diagonals of that image."
    ),
    "factors": (
        "The whole map about the fixed image's centre: M = R(rotation) @ [[1, shear_x], [shear_y, 1]] @ "
        "diag(scale_x, scale_y), then the translation t."
    ),
    "warps": "Applied from the last one listed to the first, as in ITK's composite transform.",
}


MATRICES = (
    "fixed_to_moving_px",
    "moving_to_fixed_px",
    "fixed_to_moving_physical",
    "moving_to_fixed_physical",
)


def transform_record(result: Result) -> dict[str, Any]:
    """What ``transform.json`` holds: matrices both ways, parameters by name, the convention in words."""
    warp = result.warp
    members = warp.warps if isinstance(warp, Chain) else (warp,)
    return {
        "convention": CONVENTION,
        **_matrices(result),
        "warps": [record(one) for one in members],
        "fixed": {"name": result.fixed.name, **lattice(result.fixed.grid)},
        "moving": {"name": result.moving.name, **lattice(result.moving.grid)},
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
        "seconds": result.seconds,
        "iterations": sum(level.iterations for level in result.levels),
        "evaluations": result.evaluations,
        "levels": [_level(result, index) for index in range(len(result.levels))],
        "candidates": [_candidate(result, one) for one in result.candidates],
        "choices": [{**asdict(choice), "reason": choice.reason} for choice in result.choices],
        "preset": dump(result.preset),
        "provenance": dict(result.provenance),
    }


def _candidate(result: Result, one: Candidate) -> dict[str, Any]:
    """A place of a search, where it was seen and where its last level left it, in pixels."""
    to_index, from_index = result.moving.grid.point_to_index, result.fixed.grid.index_to_point
    ways = {"seen_px": one.seen.as_affine(), "found_px": one.found.as_affine()}
    return {
        **{
            name: None if way is None else (to_index @ way @ from_index).homogeneous().tolist()
            for name, way in ways.items()
        },
        "value": one.value,
        "overlap": one.overlap,
        "values": list(one.values),
    }


def trace_rows(result: Result) -> Iterator[list[str]]:
    """Rows of ``trace.csv``, the head first: one line an iteration, a column a parameter.

    Levels of more than `MOST_COLUMNS` parameters have none.
    """
    tables = {(level.stage, level.level): parameter_names(result, level) for level in result.levels}
    columns = list(dict.fromkeys(name for table in tables.values() for name in table))
    yield ["stage", "level", "iteration", "evaluations", "value", "size", *columns, "seconds"]
    for step in result.trace:
        names = tables[step.stage, step.level]
        known = dict(zip(names, step.params, strict=True)) if names else {}
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


def parameter_names(result: Result, level: LevelReport) -> tuple[str, ...]:
    """What the parameters of a level are called; none where they are more than `MOST_COLUMNS`."""
    if len(level.params) > MOST_COLUMNS:
        return ()
    return result.preset.stages[level.stage].transform.names(level.frame)


def named_factors(result: Result) -> dict[str, float]:
    """Translation, rotation, scales and shears of a 2-D map about the fixed image's centre; empty in 3-D."""
    affine = result.warp.as_affine()
    return {} if affine is None else factors_about_centre(result, affine)


def factors_about_centre(result: Result, affine: AffineMap) -> dict[str, float]:
    """The same of any affine map."""
    if affine.dim != 2:
        return {}
    return factors(affine.matrix, translation_about(affine, result.fixed.grid.centre))


def _matrices(result: Result) -> dict[str, Any]:
    """The map both ways, in pixels and physical; empty where it bends straight lines."""
    affine, straight = result.warp.as_affine(), result.warp.as_homogeneous()
    if affine is not None:
        pixels = result.pixel_map
        matrices = [pixels, pixels.inverse(), affine, affine.inverse()]
        found: dict[str, Any] = dict(
            zip(MATRICES, (one.homogeneous().tolist() for one in matrices), strict=True)
        )
        if affine.dim == 2:
            found["factors"] = named_factors(result)
        return found
    if straight is None:
        return {}
    whole = result.pixel_matrix
    both = [whole, inverted(whole), straight, inverted(straight)]
    return dict(zip(MATRICES, (unit_depth(one).tolist() for one in both), strict=True))


def _level(result: Result, index: int) -> dict[str, Any]:
    level = result.levels[index]
    names = parameter_names(result, level)
    return {
        "stage": level.stage,
        "level": level.level,
        "size": list(reversed(level.shape)),
        "samples": level.samples,
        "places": level.places,
        "iterations": level.iterations,
        "evaluations": level.evaluations,
        "other_evaluations": level.other_evaluations,
        "start_value": level.start_value,
        "value": level.value,
        "stop": level.stop,
        "seconds": level.seconds,
        "parameter_count": len(level.params),
        "parameters": dict(zip(names, level.params, strict=True)) if names else {},
    }


def _finite(tree: object) -> object:
    if isinstance(tree, Mapping):
        return {str(key): _finite(value) for key, value in tree.items()}
    if isinstance(tree, list | tuple):
        return [_finite(value) for value in tree]
    return None if isinstance(tree, float) and not isfinite(tree) else tree
