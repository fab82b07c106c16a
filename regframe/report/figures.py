"""Plots of a result: what grey values there are, how they meet, and how the search went."""

from collections.abc import Sequence
from pathlib import PurePath
from typing import TYPE_CHECKING

import numpy as np

from regframe.engine.base import Result
from regframe.image import Image
from regframe.report import counts
from regframe.report.counts import Course
from regframe.report.png import encode
from regframe.report.starts import first_warp

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 100
DECADE = 10
SMALL, PLAIN = 8.5, 9.5
NAME_LENGTH = 40
OWN_UNIT = "optimizer's unit"
UNITS = {"shift": "pixels or mm", "grid-shift": "points of the level's grid"}
"""What steps are counted in."""
# Okabe and Ito's palette, which keeps apart for every kind of colour vision.
VERMILION, BLUE, INK, SHADE = "#D55E00", "#0072B2", "#404040", "#EEEEEE"

Box = tuple[float, float, float, float]
"""Left, bottom, width and height as shares of a figure."""


def histograms(result: Result) -> "Figure":
    """Grey values of both images as they were given, 256 bins each.

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = _figure(9.0, 3.2)
    sides = (("fixed", result.fixed, VERMILION), ("moving", result.moving, BLUE))
    for left, (role, image, colour) in zip((0.075, 0.58), sides, strict=True):
        axes = _axes(figure, (left, 0.17, 0.4, 0.72), f"{role}: {_name(image)}")
        found, edges = counts.histogram(image)
        axes.stairs(found / max(found.sum(), 1) * 100, edges, fill=True, color=colour)
        axes.set_xlim(edges[0], edges[-1])
        low, high = image.range()
        _labels(axes, f"grey value, {low:g} to {high:g}, in {len(found)} bins", "pixels, %", room=0.45)
    return figure


def joint_histogram(result: Result) -> "Figure":
    """Which grey values meet, at the start and at the end; sharper means more mutual information.

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = _figure(9.0, 4.4)
    tables = [counts.joint_histogram(result, warp) for warp in (first_warp(result), result.warp)]
    top = max(float(np.log10(1 + table.counts).max()) for table in tables) or 1.0
    for left, when, table in zip((0.09, 0.51), ("before", "after"), tables, strict=True):
        bits = counts.mutual_information(table.counts)
        box = (left, 0.13, 0.38, 0.78)
        axes = _axes(figure, box, f"{when}: mutual information {bits:.3f} bit")
        drawn = axes.imshow(
            np.log10(1 + table.counts.T),
            cmap="magma",
            vmin=0,
            vmax=top,
            extent=(*table.fixed_edges[[0, -1]], *table.moving_edges[[0, -1]]),
            origin="lower",
            aspect="auto",
            interpolation="nearest",
        )
        _labels(axes, "fixed grey value", "moving grey value" if when == "before" else "", room=0.6)
        if when == "after":
            axes.tick_params(labelleft=False)
            bar = figure.colorbar(drawn, cax=figure.add_axes((0.905, 0.13, 0.018, 0.78)))
            bar.ax.tick_params(labelsize=SMALL, colors=INK)
            figure.text(
                0.975, 0.52, "log10 (1 + pixels)", fontsize=PLAIN, rotation=90, va="center", ha="center"
            )
    return figure


def convergence(result: Result) -> "Figure":
    """Metric value and step size against evaluations, levels shaded in turn.

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = _figure(9.0, 4.6)
    courses = counts.courses(result)
    title = f"{result.preset.name or 'preset'}: {result.value:.6g} at the end"
    upper = _axes(figure, (0.11, 0.53, 0.87, 0.38), title)
    lower = _axes(figure, (0.11, 0.11, 0.87, 0.38), "")
    for axes in (upper, lower):
        axes.set_xlim(0, max(courses[-1].last, 1))
        for course in courses[1::2]:
            axes.axvspan(course.first, course.last, color=SHADE, zorder=0, linewidth=0)
    _lines(upper, courses, "value", VERMILION)
    _lines(lower, courses, "size", BLUE)
    _by_decades(lower, [step.size for step in result.trace])
    upper.tick_params(labelbottom=False)
    low, high = upper.get_ylim()
    upper.set_ylim(low, high + 0.3 * (high - low))  # room for the names of the levels
    scales = result.preset.stages[-1].scales
    unit = UNITS.get(scales, OWN_UNIT) if isinstance(scales, str) else OWN_UNIT
    _labels(upper, "", "metric value,\nlower is better", room=0.6)
    _labels(lower, "metric evaluations", f"step size,\n{unit}", room=0.6)
    _name_levels(upper, result, courses)
    return figure


def _lines(axes: "Axes", courses: Sequence[Course], field: str, colour: str) -> None:
    for course in courses:
        heights = [getattr(step, field) for step in course.steps]
        axes.plot(
            course.evaluations, heights, color=colour, linewidth=1.2, marker="." if len(heights) == 1 else ""
        )


def _name_levels(axes: "Axes", result: Result, courses: Sequence[Course]) -> None:
    """Write how coarse each level is above its part, where there is room; in two rows, as words are wide."""
    several = len(result.preset.stages) > 1
    shown = [
        (report, course)
        for report, course in zip(result.levels, courses, strict=True)
        if course.last - course.first >= 0.1 * courses[-1].last
    ]
    for number, (report, course) in enumerate(shown):
        level = result.preset.stages[report.stage].levels[report.level]
        words = f"stage {report.stage + 1}, " if several else ""
        carried = ", carried" if level.carried else ""
        at_end = course.last == courses[-1].last  # words about its middle would leave the picture
        axes.text(
            course.last if at_end else (course.first + course.last) / 2,
            0.97 - 0.1 * (number % 2),
            f"{words}level {report.level + 1}: {level.resolution}{carried}",
            transform=axes.get_xaxis_transform(),
            horizontalalignment="right" if at_end else "center",
            verticalalignment="top",
            fontsize=SMALL,
            color=INK,
        )


def _by_decades(axes: "Axes", sizes: Sequence[float]) -> None:
    """A logarithmic axis where sizes span more than a decade, with plain numbers."""
    known = [size for size in sizes if size > 0]
    if not known or max(known) < DECADE * min(known):
        return
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.minorticks_off()


def _figure(width: float, height: float) -> "Figure":
    # The object interface: pyplot would start a window system's machinery and keep every figure alive.
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), dpi=DPI)


def _axes(figure: "Figure", box: Box, title: str) -> "Axes":
    axes = figure.add_axes(box)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=SMALL, colors=INK)
    axes.locator_params(nbins=6)
    if title:
        # A title whose height is given spares a layout of every tick label.
        axes.set_title(title, loc="left", y=1.02, fontsize=PLAIN, fontweight="bold", color=INK)
    return axes


def _labels(axes: "Axes", along: str, up: str, *, room: float) -> None:
    """Axis labels at given places, which spares two more layouts of every tick label; `room` in inches."""
    axes.set_xlabel(along, fontsize=PLAIN)
    axes.set_ylabel(up, fontsize=PLAIN)
    axes.xaxis.set_label_coords(0.5, -0.32 * DPI / axes.bbox.height)
    axes.yaxis.set_label_coords(-room * DPI / axes.bbox.width, 0.5)


def _name(image: Image) -> str:
    name = PurePath(image.name).name
    return name if len(name) <= NAME_LENGTH else f"...{name[3 - NAME_LENGTH :]}"


def draw(figure: "Figure") -> bytes:
    """A figure as the bytes of a PNG file."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]  # the canvas has no annotations
    return encode(np.asarray(canvas.buffer_rgba())[..., :3])  # type: ignore[no-untyped-call]  # nor has this
