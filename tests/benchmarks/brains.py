"""Slices of heads by two methods: how far `multimodal-brain-2d` ends from what was published, and why.

``PYTHONPATH=tests python -m benchmarks.brains`` prints three tables, and ``--write`` puts them into
docs/explanation/multimodal-brain.md: the pairs as they are; the MR and PET pairs with the PET turned further,
against the published map and against the answer without that turn; and where metrics of unlike kinds have
their optimum when they begin at the published map.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping

import numpy as np
from benchmarks.made import ROOT, put, table
from conftest import DATA

from regframe import register
from regframe.geometry import AffineMap, Frame
from regframe.transforms.warp import Warp
from support.brains import SHIFTS, BrainPair, brain_pairs, turned

PAGE = ROOT / "docs" / "explanation" / "multimodal-brain.md"
PRESET = "multimodal-brain-2d"
LUMA: Mapping[str, object] = {"extends": PRESET, "name": "luma", "filters.fixed": [], "filters.moving": []}
METRICS: Mapping[str, object] = {
    "`mattes`": {"type": "mattes", "bins": 32},
    "`normalised-mi`": {"type": "normalised-mi", "bins": 32},
    "`local-correlation`": {"type": "local-correlation", "sigma": 6.0},
    "`mind-ssc`": {"type": "mind-ssc", "patch": 2.0, "reach": 4},
    "`normalised-gradient-fields`": "normalised-gradient-fields",
}
TURNS_DEG = (15.0, 45.0, 75.0, 105.0, 135.0, 165.0, 195.0, 225.0, 255.0, 285.0, 315.0, 345.0)


def answer(preset: str | Mapping[str, object], pair: BrainPair, start: Warp | None = None) -> np.ndarray:
    """The map between pixels that a preset finds."""
    return np.asarray(register(preset, pair.fixed, pair.moving, start=start).pixel_matrix)


def as_they_are() -> Iterator[list[str]]:
    """Every pair: distance from the published map, and what the answer adds to it."""
    yield ["pair", "off, px", "turn, degrees", "right, px", "down, px"]
    for pair in (*brain_pairs(DATA, "itk_brain"), *brain_pairs(DATA, "mr_pet")):
        found = answer(PRESET, pair)
        yield [pair.name, *(f"{number:.2f}" for number in (pair.apart(found), *pair.residual(found)))]


def turned_further() -> Iterator[list[str]]:
    """MR and PET, the PET turned and shifted on top."""
    yield ["pair", "grey of the PET", "off: median, px", "off: most, px", "from own answer: most, px"]
    for pair in brain_pairs(DATA, "mr_pet"):
        for name, preset in (("luma", LUMA), ("palette", PRESET)):
            own = answer(preset, pair)
            off, moved = [], []
            for number, angle in enumerate(TURNS_DEG):
                further, more = turned(pair, angle, SHIFTS[number % len(SHIFTS)])
                found = answer(preset, further)
                off.append(further.apart(found))
                moved.append(further.apart(found, more @ own))
            yield [pair.name, name, f"{np.median(off):.2f}", f"{max(off):.2f}", f"{max(moved):.2f}"]


def optima() -> Iterator[list[str]]:
    """What each metric adds to the published map when it begins there: pixels right and down."""
    pairs = brain_pairs(DATA, "mr_pet")
    yield ["metric", *(f"{pair.name}, right and down, px" for pair in pairs)]
    for name, metric in METRICS.items():
        row = [name]
        for pair in pairs:
            affine = AffineMap(pair.truth[:2, :2], pair.truth[:2, 2])
            start = Warp.of_affine(affine, Frame.about_centre(pair.fixed.grid))
            _, right, down = pair.residual(answer(near(metric), pair, start))
            row.append(f"{right:+.1f}, {down:+.1f}")
        yield row


def near(metric: object) -> Mapping[str, object]:
    """A search from a given start by one metric at full size."""
    palette = [{"type": "grey", "channel": "palette"}]
    stage = {
        "start": "identity",
        "transform": "rigid",
        "interpolator": {"type": "bspline", "order": 3},
        "metric": metric,
        "optimizer": "bfgs",
        "levels": [{"iterations": 40}],
    }
    return {"name": "near", "filters": {"fixed": palette, "moving": palette}, "stages": [stage]}


def main(arguments: list[str] | None = None) -> None:
    """Measure, and print or write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help=f"into {PAGE.name}")
    asked = parser.parse_args(arguments)
    if not (DATA / "pairs.csv").is_file():
        parser.error(f"the real images are not at {DATA}: set REGFRAME_DATA to their folder")
    for name, rows in (("pairs", as_they_are()), ("optima", optima()), ("turned", turned_further())):
        text = table(rows) + "\n"
        sys.stdout.write(f"{name}:\n\n{text}\n")
        sys.stdout.flush()
        if asked.write:
            put(PAGE, name, text)


if __name__ == "__main__":
    main()
