"""The cross-check as one figure: both metrics along each parameter, and both runs."""

from itertools import pairwise
from math import ceil, isfinite
from typing import TYPE_CHECKING

import numpy as np

from regframe.peer.report import Course, Report, Sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 100
ACROSS = 4
SMALL, PLAIN = 8.5, 9.5
# Okabe and Ito's palette, which keeps apart for every kind of colour vision.
OURS, THEIRS, INK, SHADE = "#0072B2", "#D55E00", "#404040", "#EEEEEE"
LEAST = 1e-16
"""Differences are drawn on a logarithmic axis, where zero has no place: it is drawn here."""


def figure(report: Report) -> "Figure":
    """Sweeps in rows of four, and the runs below them; a sentence where SimpleITK could run neither.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    rows = ceil(len(report.sweeps) / ACROSS)
    below = 0 if report.course is None else 1
    if not rows + below:
        return _nothing(report)
    height = 0.9 + 2.7 * rows + 3.3 * below
    whole = Figure(figsize=(13.0, height), dpi=DPI, layout="constrained")
    parts = whole.subfigures(rows + below, 1, height_ratios=[2.7] * rows + [3.3] * below, squeeze=False)
    whole.suptitle(f"{report.preset.name}: {report.verdict()}", fontsize=12, fontweight="bold", color=INK)
    for row in range(rows):
        axes = parts[row, 0].subplots(1, ACROSS, squeeze=False)[0]
        sweeps = report.sweeps[row * ACROSS : (row + 1) * ACROSS]
        for one, sweep in zip(axes, sweeps, strict=False):
            _sweep(one, sweep, report.unit)
        for one in axes[len(sweeps) :]:
            one.set_axis_off()
        axes[0].set_ylabel("metric, lower is better", fontsize=PLAIN)
        if row == 0:
            axes[0].legend(fontsize=SMALL, frameon=False)
    if report.course is not None:
        left, right = parts[rows, 0].subplots(1, 2)
        _values(left, report.course)
        _apart(right, report.course, report.unit)
    return whole


def _nothing(report: Report) -> "Figure":
    """A metric of the user's own is compared by its pairs alone, which have no curves."""
    from matplotlib.figure import Figure

    whole = Figure(figsize=(13.0, 1.4), dpi=DPI)
    whole.suptitle(f"{report.preset.name}: {report.verdict()}", fontsize=12, fontweight="bold", color=INK)
    text = "There are no curves: SimpleITK cannot run this preset. The pairs of intensities were compared."
    whole.text(0.5, 0.35, text, ha="center", fontsize=PLAIN, color=INK)
    return whole


def _sweep(axes: "Axes", sweep: Sweep, unit: str) -> None:
    _plain(axes, f"{sweep.name} alone moves")
    motion, ours, theirs = (np.array(one) for one in (sweep.motion, sweep.native, sweep.simpleitk))
    axes.plot(motion, np.where(np.isfinite(ours), ours, np.nan), color=OURS, label="regframe")
    axes.plot(
        motion,
        np.where(np.isfinite(theirs), theirs, np.nan),
        "o",
        color=THEIRS,
        fillstyle="none",
        label="SimpleITK",
    )
    axes.axvline(0.0, color=SHADE, zorder=0)
    axes.set_xlabel(f"away from the answer, {unit} of motion", fontsize=SMALL)


def _values(axes: "Axes", course: Course) -> None:
    _plain(axes, "Both runs: the metric at each iteration")
    axes.plot(course.native, color=OURS, linewidth=2.5, alpha=0.6, label="regframe")
    axes.plot(course.simpleitk, color=THEIRS, linewidth=1.0, linestyle="--", label="SimpleITK")
    _levels(axes, course)
    axes.set_xlabel("iteration", fontsize=PLAIN)
    axes.set_ylabel("metric, lower is better", fontsize=PLAIN)
    axes.legend(fontsize=SMALL, frameon=False)


def _apart(axes: "Axes", course: Course, unit: str) -> None:
    _plain(axes, "Both runs: how far apart their maps are")
    shown = [max(one, LEAST) if isfinite(one) else float("nan") for one in course.apart]
    axes.semilogy(shown, color=INK, linewidth=1.2)
    axes.axhline(1e-2, color=THEIRS, linewidth=1.0, linestyle=":")
    axes.annotate(
        f"0.01 {unit}: nobody would see it", (0.01, 1e-2), (0, 3), xycoords=("axes fraction", "data"),
        textcoords="offset points", fontsize=SMALL, color=THEIRS,
    )  # fmt: skip
    axes.set_ylim(LEAST / 3, max(1.0, *(one for one in shown if isfinite(one)), 0.0) * 3)
    axes.annotate(
        "equal to the last bit", (0.99, LEAST), (0, 3), xycoords=("axes fraction", "data"),
        textcoords="offset points", fontsize=SMALL, color=INK, ha="right",
    )  # fmt: skip
    _levels(axes, course)
    axes.set_xlabel("iteration", fontsize=PLAIN)
    axes.set_ylabel(f"largest distance at a corner, {unit}", fontsize=PLAIN)


def _levels(axes: "Axes", course: Course) -> None:
    edges = [*course.levels, max(len(course.native), len(course.simpleitk))]
    for begin, end in list(pairwise(edges))[1::2]:
        axes.axvspan(begin, end, color=SHADE, zorder=0, linewidth=0)


def _plain(axes: "Axes", title: str) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=SMALL, colors=INK)
    axes.locator_params(nbins=5)
    axes.set_title(title, loc="left", fontsize=PLAIN, fontweight="bold", color=INK)


def png(report: Report) -> bytes:
    """The figure as the bytes of a PNG file."""
    from io import BytesIO

    file = BytesIO()
    figure(report).savefig(file, format="png")
    return file.getvalue()
