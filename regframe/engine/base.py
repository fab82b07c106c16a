"""What every engine takes and gives: progress while it runs, a result when it is done."""

from abc import abstractmethod
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from regframe.component import Component
from regframe.engine.candidate import Candidate
from regframe.engine.choice import Choice
from regframe.engine.setting import Placement
from regframe.errors import GeometryError
from regframe.geometry import AffineMap, Frame
from regframe.image import Image
from regframe.preset import Preset
from regframe.transforms.warp import Chain, Warp
from regframe.types import Matrix, Params

if TYPE_CHECKING:
    from regframe.verdict.verdict import Verdict

MOST_KEPT = 10_000
"""Parameters of a step that a result keeps: hundreds of steps of a field would fill the memory."""


@dataclass(frozen=True, slots=True)
class Progress:
    """One iteration, as observers and the trace see it.

    Parameters
    ----------
    stage, level, iteration : int
        Counted from 0.
    iterations : int
        The level's limit.
    value : float
        The metric as the optimizer reports it.
    params : (p,) float64
        The transform's parameters.
    size : float
        The optimizer's step, in its coordinates.
    seconds : float
        Since the run began.
    evaluations : int
        Metric values computed so far in this level.
    candidate : int
        Which of a search's places is walked from, 0 for the best so far.
    """

    stage: int
    level: int
    iteration: int
    iterations: int
    value: float
    params: Params
    size: float
    seconds: float
    evaluations: int
    candidate: int = 0

    def kept(self) -> "Progress":
        """The step as a result keeps it: without parameters where they are more than `MOST_KEPT`."""
        return self if len(self.params) <= MOST_KEPT else replace(self, params=self.params[:0].copy())


@dataclass(frozen=True, slots=True)
class LevelReport:
    """How one level went: sizes, metric at its start and end, and why it stopped.

    `params` are the searched map's at the end of the level, and `frame` is what they speak of. Where several
    places of a search were walked side by side, all is of the one that ended best but for `places`, how many
    there were, and `other_evaluations`, those of the others.
    """

    stage: int
    level: int
    shape: tuple[int, ...]
    samples: int
    iterations: int
    evaluations: int
    start_value: float
    value: float
    stop: str
    seconds: float
    params: tuple[float, ...]
    frame: Frame
    places: int = 1
    other_evaluations: int = 0


@dataclass(frozen=True, eq=False)
class Result:
    """What a registration found.

    Parameters
    ----------
    warp : Warp or Chain
        Takes fixed points to moving points, physical, x first.
    value : float
        The last level's metric; lower is better.
    stop : str
        Why the last level stopped.
    levels : tuple of LevelReport
    preset : Preset
        Resolved: every default written out.
    provenance : mapping
        Versions, seeds, input names and hashes, times.
    fixed, moving : Image
        As they were given, before filters.
    trace : tuple of Progress
        One entry an iteration; of more than `MOST_KEPT` parameters without them.
    start : Warp or Chain, optional
        Where the first stage began.
    candidates : tuple of Candidate
        What a search found, the one that went on first; then those that came furthest, the best first.
    choices : tuple of Choice
        Of each stage that needed proof, whether its map was kept and why.
    """

    warp: Warp | Chain
    value: float
    stop: str
    levels: tuple[LevelReport, ...]
    preset: Preset
    provenance: Mapping[str, Any]
    fixed: Image
    moving: Image
    trace: tuple[Progress, ...] = field(repr=False, default=())
    start: Warp | Chain | None = field(repr=False, default=None)
    candidates: tuple[Candidate, ...] = field(repr=False, default=())
    choices: tuple[Choice, ...] = field(repr=False, default=())

    @property
    def seconds(self) -> float:
        """How long it took, a search and the filters included."""
        return float(self.provenance["seconds"])

    @property
    def evaluations(self) -> int:
        """How often the metric was measured by the levels, at all places that a search let go on."""
        return sum(level.evaluations + level.other_evaluations for level in self.levels)

    @property
    def pixel_map(self) -> AffineMap:
        """From fixed to moving pixel, x first, pixel centres at whole numbers; of affine warps alone."""
        affine = self.warp.as_affine()
        if affine is None:
            message = (
                "This warp is not affine. Take `pixel_matrix` for a homography, else call `warp(points)`."
            )
            raise GeometryError(message)
        return self.moving.grid.point_to_index @ affine @ self.fixed.grid.index_to_point

    @property
    def pixel_matrix(self) -> Matrix:
        """From fixed to moving pixel, homogeneous: (3, 3) in 2-D, (4, 4) in 3-D.

        Of a homography the last component is the depth, by which the others are divided.
        """
        if self.warp.as_affine() is not None:
            return self.pixel_map.homogeneous()
        straight = self.warp.as_homogeneous()
        if straight is None:
            message = (
                "This warp bends straight lines, so it has no pixel matrix. Call `warp(points)` instead."
            )
            raise GeometryError(message)
        to_index, from_index = self.moving.grid.point_to_index, self.fixed.grid.index_to_point
        return unit_depth(to_index.homogeneous() @ straight @ from_index.homogeneous())

    @cached_property
    def verdict(self) -> "Verdict":
        """Whether to trust the map: ``good``, ``doubtful``, ``failed`` or ``unjudged``, with its evidence.

        Made when first asked for, which may take as long as the registration did, and kept.
        """
        from regframe.verdict.verdict import judge  # a verdict is built on results, not the reverse

        return judge(self)

    def save(
        self,
        folder: str | Path,
        *,
        force: bool = False,
        figures: bool = True,
        verdict: bool = True,
        keep_failed: bool = False,
    ) -> Path:
        """Write the aligned image, overlays, plots, transform, result and trace.

        When the verdict is ``failed``, the aligned image and the transform are not written, so that no
        script picks up a wrong map.

        Parameters
        ----------
        folder : path
            Made if missing.
        force : bool
            Overwrite files of an earlier result.
        figures : bool
            Write the pictures too.
        verdict : bool
            Write the verdict too, and heed it.
        keep_failed : bool
            Write everything whatever the verdict is.

        Raises
        ------
        OutputError
            The folder cannot be written, or holds a result and `force` is off.
        """
        from regframe.report.files import save  # the report is built on results, not the reverse

        return save(
            self, Path(folder), force=force, figures=figures, verdict=verdict, keep_failed=keep_failed
        )

    def _repr_html_(self) -> str:
        from regframe.report.html import card

        return card(self)


def unit_depth(whole: Matrix) -> Matrix:
    """A homogeneous matrix scaled to depth 1 at the origin, as is customary, its sign kept."""
    depth = abs(float(whole[-1, -1]))
    return whole / depth if depth > np.finfo(np.float64).tiny else whole


class Engine(Component):
    """Who runs a preset."""

    @abstractmethod
    def iterate(
        self, preset: Preset, fixed: Image, moving: Image, *, start: Warp | Chain | Placement | None = None
    ) -> Generator[Progress, None, Result]:
        """Yield a Progress an iteration and return the Result.

        Parameters
        ----------
        start : Warp, Chain or Placement, optional
            Where the first stage begins, in place of its own `start`; or all that is known of the images'
            places.

        Raises
        ------
        NoOverlapError, GeometryError, ImageError
        """


Observer = Callable[[Progress], None]
