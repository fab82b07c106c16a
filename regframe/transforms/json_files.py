"""Warps from the ``transform.json`` of a result, which holds every family exactly."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from regframe.catalog import TRANSFORMS
from regframe.errors import GeometryError, PresetError
from regframe.geometry import Frame, Grid
from regframe.transforms.warp import Chain, Warp, chain


def record(warp: Warp) -> dict[str, Any]:
    """A warp as tables, lists and numbers.

    Examples
    --------
    >>> from regframe.transforms.rigid import Rigid
    >>> frame = Frame.about_centre(Grid.of_shape((5, 5)))
    >>> found = record(Warp(Rigid(), np.array([0.5, 3.0, 4.0]), frame))
    >>> found["type"], found["parameters"]
    ('rigid', {'angle_rad': 0.5, 'tx': 3.0, 'ty': 4.0})
    >>> warp_of(found, frame.grid).params
    array([0.5, 3. , 4. ])
    """
    numbers = list(map(float, warp.params))
    found: dict[str, Any] = {
        "type": TRANSFORMS.name_of(warp.transform),
        "options": warp.transform.model_dump(mode="json"),
        "centre": list(map(float, warp.frame.centre)),
        # A name for each of a field's many numbers would only hide them.
        "parameters": numbers
        if warp.transform.local
        else dict(zip(warp.transform.names(warp.frame), numbers, strict=True)),
    }
    if warp.as_affine() is None:
        # Such parameters are measured in the sizes of the images, or belong to control points.
        frame = warp.frame
        grids = {"fixed": frame.grid, "moving": frame.moving, "lattice": frame.lattice}
        found["grids"] = {name: lattice(grid) for name, grid in grids.items() if grid is not None}
    return found


def lattice(grid: Grid) -> dict[str, Any]:
    """A grid's size, spacing, origin and direction, x first."""
    return {
        "size": list(reversed(grid.shape)),
        "spacing": list(grid.spacing),
        "origin": list(grid.origin),
        "direction": [list(row) for row in grid.direction],
    }


def read(path: Path, grid: Grid) -> Warp | Chain:
    """Read the warps of a ``transform.json``.

    Parameters
    ----------
    path : Path
    grid : Grid
        The fixed grid of affine members; others bring their own.

    Raises
    ------
    GeometryError
        The file holds no such record, is damaged, or of other dimensions than the grid.
    """
    try:
        members = json.loads(path.read_text(encoding="utf-8"))["warps"]
        fits = all(len(one["centre"]) == grid.dim for one in members)
        found = [warp_of(one, grid) for one in members] if fits else []
    except (ValueError, KeyError, TypeError, AttributeError, IndexError, PresetError) as error:
        message = (
            f"{path}: this is not the transform.json of a result, or it is damaged ({error}). "
            "Name the one in a result's folder, or an ITK transform file."
        )
        raise GeometryError(message) from error
    if not found:
        message = f"{path}: it holds no map for a {grid.dim}-D image. Both must have the same number of axes."
        raise GeometryError(message)
    return chain(found)


def warp_of(found: Mapping[str, Any], grid: Grid) -> Warp:
    """The warp of a `record`."""
    family = TRANSFORMS.build({"type": found["type"], **found.get("options", {})})
    grids = {name: _grid(one) for name, one in found.get("grids", {}).items()}
    frame = Frame(
        grids.get("fixed", grid),
        np.array(found["centre"], np.float64),
        lattice=grids.get("lattice"),
        moving=grids.get("moving"),
    )
    told = found["parameters"]
    numbers = told if family.local else [told[name] for name in family.names(frame)]
    params = np.array(numbers, np.float64)
    if params.shape != family.identity(frame).shape:
        message = f"{len(params)} parameters for {family.identity(frame).size}"
        raise ValueError(message)
    return Warp(family, params, frame)


def _grid(found: Mapping[str, Any]) -> Grid:
    shape = tuple(int(n) for n in reversed(found["size"]))
    rows = tuple(tuple(map(float, row)) for row in found["direction"])
    return Grid(shape, tuple(map(float, found["spacing"])), tuple(map(float, found["origin"])), rows)
