"""Genuine pairs of unaligned cameras: which presets align them, how well, and how long it takes.

``PYTHONPATH=tests python -m benchmarks.unaligned`` prints the table; ``--write`` puts it into
docs/explanation/visual-thermal.md. Errors are mean distances in thermal pixels; a run succeeds within the
larger of 5 px and 3 px more than what the best similarity leaves.
"""

import argparse
from collections.abc import Mapping
from time import perf_counter

import numpy as np
from benchmarks.cases import DATA
from benchmarks.made import ROOT, put

from regframe import register
from regframe.errors import RegframeError
from support.raw_pairs import raw_pairs

PAGE = ROOT / "docs" / "explanation" / "visual-thermal.md"
SOURCES = ("roadscene_raw", "metu_vistir_raw", "flir_landmarks")
LINEAR = {"extends": "paper-similarity-pyramid", "stages.0.interpolator": "linear"}
METHODS: Mapping[str, tuple[str | Mapping[str, str], str]] = {
    "`visual-thermal`": ("visual-thermal", "native"),
    "`visual-thermal-fast`": ("visual-thermal-fast", "native"),
    "`visual-thermal-projective`": ("visual-thermal-projective", "native"),
    "`visual-thermal-radial`": ("visual-thermal-radial", "native"),
    "`paper-similarity`": ("paper-similarity", "native"),
    "`paper-similarity-pyramid`, linear": (LINEAR, "native"),
    "the same by SimpleITK": (LINEAR, "simpleitk"),
}


def measured(methods: list[str]) -> list[tuple[str, float, float, float, float]]:
    """Of each method its name, share of successes, median error, median floor and median seconds."""
    rows = []
    pairs = list(raw_pairs(DATA, SOURCES))
    for name in methods:
        preset, engine = METHODS[name]
        errors, seconds = [], []
        for pair in pairs:
            began = perf_counter()
            try:
                errors.append(pair.error(register(preset, pair.fixed, pair.moving, engine=engine).warp))
            except RegframeError:
                errors.append(np.inf)
            seconds.append(perf_counter() - began)
        limits = [max(5.0, pair.floor + 3.0) for pair in pairs]
        share = float(np.mean([error < limit for error, limit in zip(errors, limits, strict=True)]))
        floor = float(np.median([pair.floor for pair in pairs]))
        rows.append((name, share, float(np.median(errors)), floor, float(np.median(seconds[1:]))))
    return rows


def table(rows: list[tuple[str, float, float, float, float]]) -> str:
    """The rows in Markdown."""
    head = "| preset | succeeds | median error, px | median floor, px | seconds |\n|---|---|---|---|---|"
    lines = [f"| {n} | {100 * s:.0f} % | {e:.2f} | {f:.2f} | {t:.2f} |" for n, s, e, f, t in rows]
    return "\n".join([head, *lines])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--methods", nargs="*", default=list(METHODS), choices=list(METHODS))
    parser.add_argument("--write", action="store_true", help=f"put the table into {PAGE.name}")
    given = parser.parse_args()
    text = table(measured(given.methods))
    print(text)
    if given.write:
        put(PAGE, "unaligned", text)


if __name__ == "__main__":
    main()
