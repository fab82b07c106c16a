"""The figures of the page on the verdict, from the table of evidence."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray

mpl.use("Agg")
from fit import BINS, auc, calibration_error, kept_back, searched, unsearched
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from runs import Row

from regframe.verdict.calibration import FAILED, GOOD

BLUE, ORANGE, GREY = "#0072B2", "#E69F00", "#777777"

Chances = NDArray[np.float64]
Claims = NDArray[np.bool_]


def draw(rows: Sequence[Row], folder: Path) -> None:
    """Write the ROC and reliability curves, and the evidence by outcome."""
    judged = {
        "with a second search": kept_back(searched(rows)),
        "without": kept_back(unsearched(rows)),
    }
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.9), layout="constrained")
    for colour, (name, (tested, chances)) in zip((BLUE, ORANGE), judged.items(), strict=True):
        near = np.array([row.near for row in tested])
        _roc(axes[0], chances, near, name, colour)
        _reliability(axes[1], chances, near, name, colour)
    tested, chances = judged["with a second search"]
    _histogram(axes[2], chances, np.array([row.near for row in tested]))
    figure.savefig(folder / "verdict-calibration.png", dpi=110)
    plt.close(figure)
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.6), layout="constrained")
    _evidence(axes, searched(rows))
    figure.savefig(folder / "verdict-evidence.png", dpi=110)
    plt.close(figure)


def _roc(axes: Axes, chances: Chances, near: Claims, name: str, colour: str) -> None:
    order = np.argsort(-chances, kind="stable")
    hits, misses = np.cumsum(near[order]) / near.sum(), np.cumsum(~near[order]) / (~near).sum()
    label = f"{name}: area {auc(chances, near):.4f}"
    axes.step(np.r_[0, misses, 1], np.r_[0, hits, 1], color=colour, where="post", label=label)
    axes.set(
        xlim=(-0.005, 0.25),
        ylim=(0.75, 1.005),
        xlabel="share of far maps above the threshold",
        ylabel="share of near maps above it",
        title="ROC, upper left corner",
    )
    axes.legend(loc="lower right", frameon=False)


def _reliability(axes: Axes, chances: Chances, near: Claims, name: str, colour: str) -> None:
    bins = np.minimum((chances * BINS).astype(int), BINS - 1)
    filled = sorted(set(bins))
    said = [chances[bins == one].mean() for one in filled]
    true = [near[bins == one].mean() for one in filled]
    sizes = [12 + 14 * np.sqrt((bins == one).sum()) for one in filled]
    axes.plot([0, 1], [0, 1], color=GREY, linewidth=0.8, linestyle=":")
    axes.plot(said, true, color=colour, linewidth=1, alpha=0.6)
    axes.scatter(
        said, true, sizes, color=colour, alpha=0.8, label=f"{name}: {calibration_error(chances, near):.3f}"
    )
    axes.set(
        xlabel="probability that was said",
        ylabel="share that was within 5 px",
        title="Reliability, and expected calibration error",
        ylim=(-0.05, 1.3),
    )
    axes.legend(loc="upper left", frameon=False, markerscale=0.5)


def _histogram(axes: Axes, chances: Chances, near: Claims) -> None:
    edges = np.linspace(0.0, 1.0, 21)
    axes.hist(
        [chances[near], chances[~near]], edges, color=(BLUE, ORANGE), label=("near", "far"), stacked=True
    )
    for threshold in (FAILED, GOOD):
        axes.axvline(threshold, color=GREY, linewidth=0.8, linestyle=":")
    axes.set(yscale="log", xlabel="probability that was said", ylabel="runs", title="Failed, doubtful, good")
    axes.legend(frameon=False)


def _evidence(axes: Sequence[Axes], rows: Sequence[Row]) -> None:
    near = np.array([row.near for row in rows])
    trip = np.clip([row.evidence.round_trip_px or 0.0 for row in rows], 0.05, 1000.0)
    share = np.array([row.evidence.parts_near for row in rows])
    rival = np.clip([row.evidence.rival for row in rows], 0.1, 10.0)
    left = np.clip([row.evidence.leftover_px for row in rows], 0.1, 100.0)
    views = (
        (trip, share, "round trip of the second search, px", "parts near their place"),
        (trip, rival, "round trip of the second search, px", "best fit elsewhere over fit here"),
        (left, share, "leftover of a part, px", "parts near their place"),
    )
    for one, (across, up, below, beside) in zip(axes, views, strict=True):
        for side, colour, name in ((~near, ORANGE, "far"), (near, BLUE, "near")):
            one.scatter(across[side], up[side], 12, color=colour, alpha=0.6, label=name, linewidths=0)
        one.set(xscale="log", xlabel=below, ylabel=beside)
    axes[1].set_yscale("log")
    axes[0].legend(frameon=False)
