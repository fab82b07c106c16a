"""The folder that a result becomes, written whole or not at all."""

import csv
import io
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from regframe.engine.base import Result
from regframe.engine.resampling import align
from regframe.errors import OutputError
from regframe.geometry import Grid
from regframe.image import Image
from regframe.interpolators.linear import Linear
from regframe.report import records
from regframe.report.overlays import overlays
from regframe.report.png import encode

DATA = ("transform.tfm", "transform.json", "result.json", "trace.csv")
OVERLAYS = (
    "overlay-red-cyan.png",
    "overlay-difference.png",
    "overlay-checkerboard.png",
    "overlay-before.png",
)
PLOTS = ("histograms.png", "joint-histogram.png", "convergence.png")

GEOMETRIC = (".nii.gz", ".nii", ".nrrd", ".mha")
"""Formats that keep origin, spacing and direction."""


def save(
    result: Result,
    folder: Path,
    *,
    force: bool = False,
    figures: bool = True,
    verdict: bool = True,
    keep_failed: bool = False,
) -> Path:
    """Write everything a result holds into a folder; of a failed one only what shows why.

    Files appear under their names only when all of them are complete, so an interrupted run leaves
    nothing half-written. With `force` the files of an earlier result are replaced, and those it alone
    had are removed, so that a folder never mixes two results.

    Parameters
    ----------
    result : Result
    folder : Path
        Made if missing.
    force : bool
        Replace an earlier result.
    figures : bool
        Write overlays and plots too.
    verdict : bool
        Write the verdict too, and withhold the aligned image and the transform where it is ``failed``.
    keep_failed : bool
        Withhold nothing.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    OutputError
        The folder cannot be written, or holds a result and `force` is off.
    """
    check(folder, force=force)
    with _staged(folder) as temporary:
        if keep_failed or not (verdict and result.verdict == "failed"):
            _write_map(result, temporary)
        _write_run(result, temporary, verdict)
        if figures:
            _draw(result, temporary)
        new = sorted(path.name for path in temporary.iterdir())
        for old in earlier(folder):
            if old not in new:
                (folder / old).unlink()
        for name in new:
            (temporary / name).replace(folder / name)
    return folder


def check(folder: Path, *, force: bool = False) -> None:
    """Refuse a folder that a result cannot be written into; looks, and changes nothing.

    Raises
    ------
    OutputError
        It is a file, cannot be written, or holds a result and `force` is off.
    """
    if folder.exists() and not folder.is_dir():
        message = f"the output folder {str(folder)!r} is a file. Name a folder."
        raise OutputError(message)
    taken = earlier(folder)
    if taken and not force:
        more = f" and {len(taken) - 1} more" if len(taken) > 1 else ""
        message = (
            f"the output folder {str(folder)!r} already holds {taken[0]!r}{more}. "
            "Name another folder, or add --force (force=True) to replace that result."
        )
        raise OutputError(message)
    nearest = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    if not nearest.is_dir() or not os.access(nearest, os.W_OK | os.X_OK):
        message = f"the output folder {str(folder)!r} cannot be written: no permission in {str(nearest)!r}."
        raise OutputError(message)


def earlier(folder: Path) -> list[str]:
    """Files of an earlier result in a folder, by the names that results use."""
    if not folder.is_dir():
        return []
    known = {*DATA, *OVERLAYS, *PLOTS, *(f"aligned{suffix}" for suffix in (".png", ".tiff", *GEOMETRIC))}
    return sorted(path.name for path in folder.iterdir() if path.name in known)


def aligned_name(moving: Image, grid: Grid) -> str:
    """Name of the aligned image: the moving image's own format where that can hold its pixels and place.

    Parameters
    ----------
    moving : Image
        Its name tells its format, its pixels their type.
    grid : Grid
        The fixed grid.
    """
    name = moving.name.lower()
    geometric = next((suffix for suffix in GEOMETRIC if name.endswith(suffix)), None)
    if geometric:
        return f"aligned{geometric}"
    if grid != Grid.of_shape(grid.shape):
        # Picture formats would forget where the fixed grid lies.
        return "aligned.mha" if grid.dim == 2 else "aligned.nii.gz"
    if grid.dim == 3:
        return "aligned.nii.gz"
    stored = moving.values if moving.raw is None else moving.raw
    if stored.dtype in (np.uint8, np.uint16, np.bool_) and not name.endswith((".tif", ".tiff")):
        return "aligned.png"
    wide_colour = stored.ndim > grid.dim and stored.dtype.itemsize > 4
    return "aligned.nrrd" if wide_colour else "aligned.tiff"


def _write_map(result: Result, folder: Path) -> None:
    """What others go on with: the aligned image and the transform."""
    from regframe.io import write
    from regframe.transforms import files

    fixed, moving = result.fixed, result.moving
    way = result.preset.stages[-1].interpolator
    # Linear interpolation is quick to search with, and blurs. Any other was chosen for what it does.
    aligned = align(moving, fixed.grid, result.warp, None if isinstance(way, Linear) else way)
    if aligned.dtype == np.float16:
        # No image format holds half-precision numbers.
        aligned = aligned.astype(np.float32)
    write(aligned, fixed.grid, folder / aligned_name(moving, fixed.grid))
    files.write(result.warp, folder / "transform.tfm")
    _write_json(records.transform_record(result), folder / "transform.json")


def _write_run(result: Result, folder: Path, verdict: bool) -> None:
    """What tells how the map was found, and whether to trust it."""
    _write_json(records.result_record(result, verdict=verdict), folder / "result.json")
    table = io.StringIO()
    csv.writer(table, lineterminator="\n").writerows(records.trace_rows(result))
    (folder / "trace.csv").write_text(table.getvalue(), encoding="utf-8")


def _write_json(record: Mapping[str, object], path: Path) -> None:
    path.write_text(records.to_json(record) + "\n", encoding="utf-8")


def _draw(result: Result, folder: Path) -> None:
    from regframe.report import figures

    for name, picture in overlays(result).items():
        (folder / f"overlay-{name}.png").write_bytes(encode(picture))
    plots = (figures.histograms, figures.joint_histogram, figures.convergence)
    for name, plot in zip(PLOTS, plots, strict=True):
        (folder / name).write_bytes(figures.draw(plot(result)))


@contextmanager
def _staged(folder: Path) -> Iterator[Path]:
    """A temporary folder inside `folder`, which is made first and taken away again on failure."""
    made = [place for place in (folder, *folder.parents) if not place.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(prefix=".unfinished-", dir=folder))
    except OSError as error:
        message = (
            f"the output folder {str(folder)!r} cannot be written: {error.strerror}. Name another folder."
        )
        raise OutputError(message) from error
    done = False
    try:
        yield temporary
        done = True
    except OSError as error:
        message = (
            f"the result cannot be written into {str(folder)!r}: {error.strerror or error}. Make room there."
        )
        raise OutputError(message) from error
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
        if not done:
            for place in made:
                _remove_empty(place)


def _remove_empty(folder: Path) -> None:
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
