"""What every transform must hold, in each of its dimensions."""

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from regframe.errors import GeometryError, NoTwin, OutputError
from regframe.geometry import AffineMap, Frame, Grid
from regframe.testing.claims import NotApplicable, require, require_close, unchanged
from regframe.transforms.base import Transform
from regframe.transforms.warp import Warp
from regframe.types import Params, Points

ROUNDING = 1e-9  # mm, of points some tens of mm from the origin
MOTION = 3.0  # mm, about as far as the tried parameters move a corner each


def example_frame(dim: int) -> Frame:
    """A small oblique grid with uneven spacing, and a centre that is not its own.

    Examples
    --------
    >>> example_frame(3).grid.shape
    (5, 6, 7)
    """
    cos, sin = np.cos(0.3), np.sin(0.3)
    turned = np.eye(dim)
    turned[:2, :2] = [[cos, -sin], [sin, cos]]
    direction = tuple(tuple(map(float, row)) for row in turned)
    spacing, origin = (0.8, 1.5, 2.0)[:dim], (-4.0, 11.0, 3.0)[:dim]
    grid = Grid((5, 6, 7)[3 - dim :], spacing, origin, direction)
    return Frame(grid, grid.centre + np.array([1.3, -0.7, 0.4])[:dim])


def example_params(transform: Transform, frame: Frame, *, seed: int = 1, motion: float = MOTION) -> Params:
    """Parameters some millimetres of motion away from the identity."""
    identity = transform.identity(frame)
    reach = np.maximum(_reach(transform, identity, frame), 1e-6)
    # Never 0 for any parameter, so that none can hide.
    drawn = np.random.default_rng((seed, 8)).uniform(0.3, 1.0, (2, len(identity)))
    return np.asarray(identity + motion / 2 * np.where(drawn[1] > 0.65, drawn[0], -drawn[0]) / reach)


def check_identity_moves_nothing(transform: Transform) -> None:
    """The identity maps every point to itself."""
    for frame, points in _places(transform):
        moved = transform.map(transform.identity(frame), points, frame)
        require_close(moved, points, within=ROUNDING, fault=f"{_dim(frame)}: `identity` moves points.")


def check_identity_is_fresh(transform: Transform) -> None:
    """Each call gives an array of its own, float64, of one axis."""
    for frame, _ in _places(transform):
        first = transform.identity(frame)
        require(
            first.dtype == np.float64 and first.ndim == 1,
            f"{_dim(frame)}: `identity` must be one row of float64. Got {first.dtype}, shape {first.shape}.",
        )
        kept = first.copy()
        first += 1.0
        again = transform.identity(frame)
        require(
            unchanged(kept, again),
            f"{_dim(frame)}: changing one `identity` changes the next. Return a new array.",
        )


def check_leaves_its_input_alone(transform: Transform) -> None:
    """`map` and `parameter_gradient` write into none of the arrays they are given."""
    for frame, points in _places(transform):
        params = example_params(transform, frame)
        forces = np.ones_like(points)
        given = {"params": params, "points": points, "forces": forces}
        before = {name: array.copy() for name, array in given.items()}
        transform.map(params, points, frame)
        _untouched(before, given, f"{_dim(frame)}: `map`")
        transform.parameter_gradient(params, points, forces, frame)
        _untouched(before, given, f"{_dim(frame)}: `parameter_gradient`")


def check_maps_points_one_by_one(transform: Transform) -> None:
    """A point goes to the same place in whatever company it is mapped."""
    for frame, points in _places(transform):
        params = example_params(transform, frame)
        together = transform.map(params, points, frame)
        require(
            together.shape == points.shape and together.dtype == np.float64,
            f"{_dim(frame)}: `map` must give float64 {points.shape}. Got {together.dtype} {together.shape}.",
        )
        alone = np.concatenate([transform.map(params, point[None], frame) for point in points[:7]])
        require_close(
            alone, together[:7], within=ROUNDING, fault=f"{_dim(frame)}: mapping depends on the other points."
        )


def check_names_fit_the_parameters(transform: Transform) -> None:
    """Each parameter has one name of its own."""
    for frame, _ in _places(transform):
        names, count = transform.names(frame), len(transform.identity(frame))
        require(len(names) == count, f"{_dim(frame)}: {len(names)} names for {count} parameters: {names}.")
        require(len(set(names)) == count, f"{_dim(frame)}: two parameters share a name: {names}.")


def check_every_parameter_moves_something(transform: Transform) -> None:
    """Each parameter, changed alone, moves some point."""
    for frame, points in _places(transform):
        params = example_params(transform, frame)
        here = transform.map(params, points, frame)
        for i, name in enumerate(transform.names(frame)):
            moved = params.copy()
            moved[i] += 1e-3
            require(
                bool(np.any(transform.map(moved, points, frame) != here)),
                f"{_dim(frame)}: parameter {i} ({name}) moves no point. Leave it out.",
            )


def check_as_affine_equals_map(transform: Transform) -> None:
    """`as_affine` is the same map as `map`."""
    for frame, points in _places(transform):
        params = example_params(transform, frame)
        affine = _affine(transform, params, frame)
        require_close(
            affine(points),
            transform.map(params, points, frame),
            within=ROUNDING,
            fault=f"{_dim(frame)}: `as_affine` and `map` put a point at different places.",
        )


def check_as_homogeneous_equals_map(transform: Transform) -> None:
    """`as_homogeneous` is the same map as `map`, and `from_homogeneous` finds it again."""
    for frame, points in _places(transform):
        params = example_params(transform, frame)
        whole = transform.as_homogeneous(params, frame)
        if whole is None:
            message = "the transform bends straight lines"
            raise NotApplicable(message)
        lifted = np.column_stack([points, np.ones(len(points))]) @ whole.T
        wanted = transform.map(params, points, frame)
        require(
            bool(np.all(lifted[:, -1] > 0)), f"{_dim(frame)}: `as_homogeneous` has points at depth 0 or less."
        )
        require_close(
            lifted[:, :-1] / lifted[:, -1:],
            wanted,
            within=ROUNDING,
            fault=f"{_dim(frame)}: `as_homogeneous` and `map` put a point at different places.",
        )
        require_close(
            transform.map(transform.from_homogeneous(whole, frame), points, frame),
            wanted,
            within=ROUNDING,
            fault=f"{_dim(frame)}: `from_homogeneous(as_homogeneous(params))` is another map.",
        )


def check_from_affine_restores_as_affine(transform: Transform) -> None:
    """`from_affine` finds parameters of the map that `as_affine` gave."""
    for frame, points in _places(transform):
        params = example_params(transform, frame)
        found = transform.from_affine(_affine(transform, params, frame), frame)
        require_close(
            transform.map(found, points, frame),
            transform.map(params, points, frame),
            within=ROUNDING,
            fault=f"{_dim(frame)}: `from_affine(as_affine(params))` is another map.",
        )


def check_inverse_undoes(transform: Transform) -> None:
    """A warp after its inverse, and before it, moves nothing."""
    for frame, points in _places(transform):
        # Little motion: a lens's law holds up to some radius, and points beyond it have no way back.
        params = example_params(transform, frame, motion=MOTION / 3)
        warp = Warp(transform, params, frame)
        if transform.inverse(params, frame) is None:
            _affine(transform, params, frame)
        for name, both in (
            ("warp @ inverse", warp @ warp.inverse()),
            ("inverse @ warp", warp.inverse() @ warp),
        ):
            require_close(
                both(points),
                points,
                within=1e-7,
                fault=f"{_dim(frame)}: {name} moves points; check `inverse`, or `from_affine`.",
            )


def check_composes(transform: Transform) -> None:
    """A chain of two warps maps as one after the other, and so does its affine form."""
    for frame, points in _places(transform):
        first, second = (Warp(transform, example_params(transform, frame, seed=s), frame) for s in (1, 2))
        both, wanted = second @ first, second(first(points))
        require_close(
            both(points), wanted, within=ROUNDING, fault=f"{_dim(frame)}: a chain is not its parts in turn."
        )
        whole = both.as_affine()
        if whole is not None:
            require_close(
                whole(points),
                wanted,
                within=ROUNDING,
                fault=f"{_dim(frame)}: a chain's `as_affine` is another map.",
            )


def check_parameter_gradient_matches_differences(transform: Transform) -> None:
    """`parameter_gradient` is the sum of forces times the slopes of `map`."""
    for frame, points in _places(transform):
        params = example_params(transform, frame)
        forces = np.random.default_rng(9).standard_normal(points.shape)
        got = transform.parameter_gradient(params, points, forces, frame)
        steps = 1e-4 / np.maximum(_reach(transform, params, frame), 1e-6)
        wanted, size = np.empty_like(params), np.empty_like(params)
        for i, step in enumerate(steps):
            move = np.zeros_like(params)
            move[i] = step
            ahead, behind = (transform.map(params + side * move, points, frame) for side in (1, -1))
            terms = forces * (ahead - behind) / (2 * step)
            wanted[i], size[i] = terms.sum(), np.abs(terms).sum()
        scale = np.maximum(size, 1e-12)
        require_close(
            got / scale,
            wanted / scale,
            within=1e-6,
            fault=f"{_dim(frame)}: `parameter_gradient` is not the slope of `map` (shown as shares).",
        )


def check_shift_matches_motion(transform: Transform) -> None:
    """`shift` is the largest motion of the grid's points per unit of each parameter."""
    for frame, _ in _places(transform):
        params = example_params(transform, frame)
        got, wanted = transform.shift(params, frame), _reach(transform, params, frame)
        require_close(
            got / np.maximum(wanted, 1e-12),
            np.ones_like(wanted),
            within=1e-2,
            fault=f"{_dim(frame)}: `shift` is not the grid's largest motion per unit (shown as a ratio).",
        )


def check_survives_itk_files(transform: Transform) -> None:
    """A warp written as an ITK transform and read again is the same map."""
    if find_spec("regframe.transforms.files") is None:
        message = "this regframe reads and writes no transform files"
        raise NotApplicable(message)
    from regframe.transforms import files

    for frame, points in _places(transform):
        warp = Warp(transform, example_params(transform, frame), frame)
        if not files.exact(warp):
            message = "ITK has no such transform, and gets a displacement field"
            raise NotApplicable(message)
        with TemporaryDirectory() as folder:
            path = Path(folder) / "warp.tfm"
            try:
                files.write(warp, path)
            except (NoTwin, OutputError, GeometryError) as error:
                message = f"it has no ITK file: {error}"
                raise NotApplicable(message) from error
            read = files.read(path, frame.grid)
        require_close(
            read(points),
            warp(points),
            within=ROUNDING,
            fault=f"{_dim(frame)}: an ITK file gives another map back.",
        )


CHECKS = (
    check_identity_moves_nothing,
    check_identity_is_fresh,
    check_leaves_its_input_alone,
    check_maps_points_one_by_one,
    check_names_fit_the_parameters,
    check_every_parameter_moves_something,
    check_as_affine_equals_map,
    check_as_homogeneous_equals_map,
    check_from_affine_restores_as_affine,
    check_inverse_undoes,
    check_composes,
    check_parameter_gradient_matches_differences,
    check_shift_matches_motion,
    check_survives_itk_files,
)


def _places(transform: Transform) -> Iterator[tuple[Frame, Points]]:
    """Every frame the transform says it works in, with points on and between its grid's."""
    require(
        bool(transform.dimensions) and set(transform.dimensions) <= {2, 3},
        f"`dimensions` may hold 2 and 3. Got {transform.dimensions}.",
    )
    for dim in transform.dimensions:
        frame = example_frame(dim)
        grid = frame.grid
        between = np.random.default_rng(10).random((30, dim)) * (np.array(grid.shape) - 1)
        yield frame, grid.points(np.concatenate([grid.all_indices(), between]))


def _reach(transform: Transform, params: Params, frame: Frame) -> Params:
    """Largest motion over the grid per unit of each parameter, by central differences, (p,)."""
    points, step = frame.grid.points(frame.grid.all_indices()), 1e-5
    found = np.empty_like(params)
    for i in range(len(params)):
        move = np.zeros_like(params)
        move[i] = step
        ahead, behind = (transform.map(params + side * move, points.copy(), frame) for side in (1, -1))
        found[i] = np.sqrt(((ahead - behind) ** 2).sum(axis=1)).max() / (2 * step)
    return found


def _affine(transform: Transform, params: Params, frame: Frame) -> AffineMap:
    affine = transform.as_affine(params, frame)
    if affine is None:
        message = "the transform is not affine"
        raise NotApplicable(message)
    return affine


def _untouched(before: dict[str, Points], after: dict[str, Points], who: str) -> None:
    touched = [name for name, array in after.items() if not unchanged(before[name], array)]
    require(not touched, f"{who} writes into {', '.join(touched)}. Copy before changing.")


def _dim(frame: Frame) -> str:
    return f"{frame.dim}-D"
