"""How much each difficulty may grow before a visual-thermal registration fails.

``PYTHONPATH=tests python -m benchmarks.robustness`` runs what is not in its file of results yet and prints
the table; ``--write`` puts table and figure into docs/explanation/robustness.md. The moving frame is the
thermal one, placed by a known similarity and then made worse; a run succeeds if what both frames see ends
within 3 px of the truth on average.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from benchmarks.cases import Case, Reach, Scene, apart, drawn, kept, placed, real, scenes, seen, with_thermal
from benchmarks.made import ROOT, put
from numpy.random import Generator
from scipy import ndimage

from regframe import register
from regframe.errors import RegframeError
from regframe.testing.phantoms import misalignment
from regframe.types import Volume

PAGE = ROOT / "docs" / "explanation" / "robustness.md"
FIGURE = ROOT / "docs" / "images" / "robustness.png"
GOOD_PX = 3.0
NEAR_PX, WORDS = 5.0, ("good", "doubtful", "failed", "unjudged")
"""What the verdict is about, and what it says."""
LINEAR: Mapping[str, object] = {"extends": "paper-similarity-pyramid", "stages.0.interpolator": "linear"}
METHODS: Mapping[str, tuple[str | Mapping[str, object], str]] = {
    "visual-thermal": ("visual-thermal", "native"),
    "SimpleITK, Mattes and (1+1)-EA, 3 levels": (LINEAR, "simpleitk"),
    "Mattes and (1+1)-EA, 3 levels": (LINEAR, "native"),
}
"""Preset and engine. The last two take the same steps (docs/explanation/agreement.md), the last sooner."""
FAR, NEAR = 0.54, 0.75
"""Largest share of the frames kept: what lies outside is for the camera that looks elsewhere."""
SMALL = Reach(angle_deg=4.0, log_scale=0.04, shift=0.04, kept=NEAR)

Degrade = Callable[[Volume, float, Generator], Volume]


@dataclass(frozen=True)
class Factor:
    """One difficulty and the amounts of it that are tried."""

    unit: str
    amounts: tuple[float, ...]
    make: Callable[[Scene, float, Generator], Case]


def turned(scene: Scene, amount: float, rng: Generator) -> Case:
    """Rotated by so many degrees to either side."""
    return moved(scene, rng, angle_deg=amount * rng.choice([-1.0, 1.0]))


def scaled(scene: Scene, amount: float, rng: Generator) -> Case:
    """Magnified by so much."""
    return moved(scene, rng, scale=amount)


def shifted(scene: Scene, amount: float, rng: Generator) -> Case:
    """Off by so much of the width, to either side."""
    return moved(scene, rng, across=amount * rng.choice([-1.0, 1.0]))


def moved(
    scene: Scene, rng: Generator, *, angle_deg: float = 0.0, scale: float = 1.0, across: float = 0.0
) -> Case:
    """One large motion and small shifts beside it; wide scenes are cut smaller where a turn asks for it."""
    for share in np.arange(FAR, 0.3, -0.04):
        grid, _ = kept(scene, share)
        for _ in range(30):
            aside = rng.uniform(-0.02, 0.02, 2)
            shift = ((across + aside[0]) * grid.shape[1], aside[1] * grid.shape[1])
            truth = misalignment(grid, grid, angle_deg=angle_deg, scale=scale, shift_px=shift)
            made = placed(scene, share, truth)
            if made is not None:
                return made
    message = f"{scene.name}: nothing was photographed there."
    raise RuntimeError(message)


def worse(degrade: Degrade, bits: int = 8) -> Callable[[Scene, float, Generator], Case]:
    """A small similarity, and a thermal frame made worse."""

    def make(scene: Scene, amount: float, rng: Generator) -> Case:
        case = drawn(scene, SMALL, rng)
        thermal = np.asarray(case.moving.values, np.float64)
        return with_thermal(case, degrade(thermal, amount, rng), bits=bits)

    return make


def noisy(thermal: Volume, amount: float, rng: Generator) -> Volume:
    """White noise of so much of the full range."""
    return np.asarray(thermal + 255.0 * amount * rng.normal(size=thermal.shape))


def blurred(thermal: Volume, amount: float, _: Generator) -> Volume:
    """A Gaussian of so many pixels."""
    return np.asarray(ndimage.gaussian_filter(thermal, amount) if amount else thermal)


def occluded(thermal: Volume, amount: float, rng: Generator) -> Volume:
    """A warm rectangle with an outline of its own over so much of the frame."""
    height, width = (round(n * amount**0.5) for n in thermal.shape)
    top, left = (int(rng.integers(0, n - m + 1)) for n, m in zip(thermal.shape, (height, width), strict=True))
    hidden = thermal.copy()
    warm = ndimage.gaussian_filter(rng.normal(size=(height, width)), 3.0) if height else np.zeros((0, 0))
    hidden[top : top + height, left : left + width] = 180.0 + 200.0 * warm
    return hidden


def inverted(thermal: Volume, amount: float, _: Generator) -> Volume:
    """Black for white, or not."""
    return 255.0 - thermal if amount else thermal


def hot(thermal: Volume, amount: float, rng: Generator) -> Volume:
    """Counts of 14 bits in a narrow part of their range, with so many pixels stuck at its ends."""
    counts = 7000.0 + 4.0 * thermal + rng.normal(size=thermal.shape)
    stuck = rng.choice(counts.size, int(amount), replace=False)
    counts.flat[stuck[::2]], counts.flat[stuck[1::2]] = 16383.0, 0.0
    return counts


FACTORS: Mapping[str, Factor] = {
    "rotation": Factor("degrees", (0, 10, 20, 30), turned),
    "relative scale": Factor("", (0.6, 0.8, 1, 1.3, 1.7), scaled),
    "shift": Factor("of the width", (0, 0.1, 0.2, 0.3, 0.4), shifted),
    "thermal noise": Factor("of the range", (0, 0.02, 0.05), worse(noisy)),
    "thermal blur": Factor("px", (0, 1.5, 3), worse(blurred)),
    "occlusion": Factor("of the frame", (0, 0.1, 0.25), worse(occluded)),
    "contrast": Factor("1: inverted", (0, 1), worse(inverted)),
    "14 bits, stuck pixels": Factor("pixels", (0, 10, 50, 200), worse(hot, bits=14)),
}

Results = dict[str, tuple[float, str]]
"""Error in pixels, and what the verdict says of it, by ``method / factor / amount / scene``."""


def run(methods: list[str], names: list[str], chosen: list[Scene], file: Path) -> Results:
    """What became of all runs asked for; those that the file has are not run again."""
    known = json.loads(file.read_text()) if file.is_file() else {}
    results: Results = {key: (off, word) for key, (off, word) in known.items()}
    # Scene by scene, so that a run broken off has something to say of every amount.
    for number, scene in enumerate(chosen):
        for name in names:
            for amount in FACTORS[name].amounts:
                # The scene and the factor alone decide on all that is random.
                rng = np.random.default_rng((list(FACTORS).index(name), number))
                case = FACTORS[name].make(scene, amount, rng)
                for method in methods:
                    key = " / ".join((method, name, f"{amount:g}", scene.name))
                    if key not in results:
                        results[key] = off, word = outcome(method, case)
                        keep(results, file)
                        sys.stderr.write(f"{key}: {off:.2f} px {word}\n")
    return results


def outcome(method: str, case: Case) -> tuple[float, str]:
    """Mean distance, in thermal pixels, over what both frames see, infinite if the run gave up; the verdict.

    Of SimpleITK's runs no verdict is asked.
    """
    preset, engine = METHODS[method]
    try:
        result = register(preset, case.fixed, case.moving, engine=engine)
    except RegframeError:
        return float("inf"), "failed"
    points = seen(case.fixed.grid, case.moving.grid, case.truth)
    off = apart(result.warp(points), case.truth(points))
    return off, str(result.verdict) if engine == "native" else ""


def keep(results: Results, file: Path) -> None:
    """Write the file, whole or not at all."""
    new = file.with_suffix(".new")
    new.write_text(json.dumps(results, indent=0))
    new.replace(file)


def share(results: Results, method: str, name: str, amount: float) -> float:
    """Of the runs that succeeded; NaN if there are none."""
    start = " / ".join((method, name, f"{amount:g}", ""))
    errors = [off for key, (off, _) in results.items() if key.startswith(start)]
    return float(np.mean(np.array(errors) < GOOD_PX)) if errors else float("nan")


def table(results: Results, methods: list[str], names: list[str]) -> str:
    """Share of successes, one line a factor and method."""
    rows = ["| difficulty | method | success at each amount |", "|---|---|---|"]
    for name in names:
        factor = FACTORS[name]
        for method in methods:
            cells = [f"{amount:g}: {share(results, method, name, amount):.0%}" for amount in factor.amounts]
            title = f"{name}, {factor.unit}" if factor.unit else name
            rows.append(f"| {title} | {label(method)} | {' · '.join(cells)} |")
    return "\n".join(rows)


def said(results: Results, method: str) -> str:
    """How often the verdict said what, of runs that it should call good and of others."""
    outcomes = [found for key, found in results.items() if key.startswith(f"{method} / ")]
    near = Counter(word for off, word in outcomes if off < NEAR_PX)
    far = Counter(word for off, word in outcomes if not off < NEAR_PX)
    parts = [
        f"of {one.total()} {which} {', '.join(f'{one[word]} {word}' for word in WORDS if one[word])}"
        for one, which in ((near, f"runs within {NEAR_PX:g} px"), (far, "others"))
    ]
    return f"The verdict on {label(method)} says {'; '.join(parts)}."


def label(method: str) -> str:
    """A preset's name as code."""
    return f"`{method}`" if method == METHODS[method][0] else method


def draw(results: Results, methods: list[str], path: Path) -> None:
    """One curve a method, one panel a factor."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (name, factor) in zip(figure.subplots(2, 4, sharey=True).flat, FACTORS.items(), strict=True):
        for method, style in zip(methods, ("o-", "s--", "^:", "v-."), strict=False):
            shares = [100.0 * share(results, method, name, amount) for amount in factor.amounts]
            axes.plot(factor.amounts, shares, style, label=method, clip_on=False, markersize=5)
        axes.set(title=name, xlabel=factor.unit, ylim=(0, 105))
        axes.grid(alpha=0.3)
        if name == "contrast":
            axes.set(xticks=[0, 1], xticklabels=["as is", "inverted"], xlabel="")
    figure.supylabel(f"runs within {GOOD_PX:g} px, percent")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=len(methods))
    figure.savefig(path.with_suffix(".new"), format="png", dpi=110)
    path.with_suffix(".new").replace(path)


def main(arguments: list[str] | None = None) -> None:
    """Run, print, and write where asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=12, help="no more than so many")
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS)[:2])
    parser.add_argument("--factors", nargs="+", choices=FACTORS, default=list(FACTORS))
    parser.add_argument("--results", type=Path, default=Path("robustness.json"), help="kept between runs")
    parser.add_argument("--write", action="store_true", help=f"into {PAGE.name}")
    asked = parser.parse_args(arguments)
    chosen = scenes(asked.scenes)
    results = run(asked.methods, asked.factors, chosen, asked.results)
    chosen_names = {scene.name for scene in chosen}
    results = {key: found for key, found in results.items() if key.rpartition(" / ")[2] in chosen_names}
    kind = "real scenes (RoadScene)" if real() else "phantoms"
    words = " ".join(said(results, method) for method in asked.methods if METHODS[method][1] == "native")
    text = f"{len(chosen)} {kind}:\n\n{table(results, asked.methods, asked.factors)}\n\n{words}\n"
    sys.stdout.write(text)
    if asked.write:
        draw(results, asked.methods, FIGURE)
        figure = f"![Share of runs that succeed against each difficulty](../images/{FIGURE.name})"
        put(PAGE, "robustness", f"{text}\n{figure}\n")


if __name__ == "__main__":
    main()
