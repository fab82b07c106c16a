"""All multimodal metrics on the same pairs: where their optimum is, and from how far it is found.

``PYTHONPATH=tests python -m benchmarks.multimodal`` prints the table, and ``--write`` puts it into
docs/explanation/multimodal-metrics.md. After Skerl, Likar and Pernus, "A protocol for evaluation of
similarity measures for rigid registration", IEEE Transactions on Medical Imaging 25(6), 2006: values along
lines through the truth; and local searches from starts at known distances.
"""

import argparse
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import islice
from time import process_time

import numpy as np
from benchmarks.cases import Case, Reach, each, real
from benchmarks.made import ROOT, put
from numpy.random import Generator

from regframe.catalog import METRICS, OPTIMIZERS
from regframe.engine.objective import Objective
from regframe.engine.scales import coordinates
from regframe.engine.scene import prepare
from regframe.errors import RegframeError
from regframe.metrics.base import Metric, Pairs
from regframe.preset import Level, Stage
from regframe.testing.phantoms import corner_error, visual_thermal
from regframe.transforms.warp import Warp
from regframe.types import Params

PAGE = ROOT / "docs" / "explanation" / "multimodal-metrics.md"
METRIC: Mapping[str, object] = {
    "oriented-gradients": "oriented-gradients",
    "mind-ssc": "mind-ssc",
    "normalised-gradient-fields": "normalised-gradient-fields",
    "mattes": {"type": "mattes", "bins": 32},
    "normalised-mi": {"type": "normalised-mi", "bins": 32},
    "joint-histogram-mi": "joint-histogram-mi",
    "local-correlation": "local-correlation",
    "ants-correlation": "ants-correlation",
    "correlation": "correlation",
    "sum of oriented-gradients and mattes": {"type": "sum", "parts": ["oriented-gradients", "mattes"]},
}
REACH = Reach(angle_deg=6.0, log_scale=0.08, shift=0.07, kept=0.7)
LEVEL = Level(shrink=2, smooth=1.0)
LINES, FARTHEST_PX, STEP_PX = 4, 24.0, 1.5
STARTS_PX, TURNS, ITERATIONS = (5.0, 10.0, 20.0), 2, 30
GOOD_PX = 3.0


@dataclass
class Found:
    """What was met of one metric; distances in fixed pixels, means over the corners."""

    off: list[float] = field(default_factory=list)  # best place of each line from the truth
    capture: list[float] = field(default_factory=list)  # how far each line rises from there, on each side
    ends: dict[float, list[float]] = field(default_factory=dict)  # error after a search, by start


@dataclass(frozen=True)
class Landscape:
    """A metric around the truth of a case, in pixels of motion."""

    objective: Objective
    case: Case
    stage: Stage

    @classmethod
    def of(cls, case: Case, metric: Metric) -> "Landscape":
        """At the comparison's one level."""
        stage = Stage(
            transform="similarity",
            interpolator="linear",
            metric=metric,
            optimizer={"type": "lbfgsb", "convergence_factor": 1e9},
        )
        scene, _ = prepare(stage, LEVEL, case.fixed, case.moving, 1)
        truth = case.truth
        space, _ = coordinates(stage, truth.params, truth.frame, scene.grid, case.moving.grid)
        return cls(Objective(stage, scene, truth.frame, space), case, stage)

    def along(self, direction: Params, places: Params) -> Params:
        """Values at places of a line through the truth."""
        return self.objective.values(places[:, None] * direction)

    def error(self, at: Params) -> float:
        """Mean distance of the corners from where they belong."""
        truth = self.case.truth
        warp = Warp(truth.transform, self.objective.coordinates.params(at), truth.frame)
        return corner_error(warp, truth, self.case.fixed.grid)

    def direction(self, rng: Generator) -> Params:
        """A random direction of unit mean motion."""
        drawn = rng.normal(size=4)
        return np.asarray(drawn / self.error(drawn))

    def searched(self, start: Params) -> float:
        """Error of a local search's end; infinite where it gave up."""
        optimizer = OPTIMIZERS.build(self.stage.optimizer)
        at = start
        try:
            for step in islice(optimizer.steps(self.objective, start, np.random.default_rng(1)), ITERATIONS):
                at = step.params
        except RegframeError:
            return float("inf")
        return self.error(at)


def measure(metric: Metric, cases: list[Case]) -> Found:
    """One metric on all cases; the same lines and starts whatever the metric."""
    found = Found(ends={distance: [] for distance in (0.0, *STARTS_PX)})
    places = np.arange(-FARTHEST_PX, FARTHEST_PX + STEP_PX / 2, STEP_PX)
    for number, case in enumerate(cases):
        rng, land = np.random.default_rng((7, number)), Landscape.of(case, metric)
        for _ in range(LINES):
            values = land.along(land.direction(rng), places)
            best = int(np.argmin(values))
            found.off.append(abs(float(places[best])))
            for side in (values[best:], values[best::-1]):
                found.capture.append(STEP_PX * rising(side))
        found.ends[0.0].append(land.searched(np.zeros(4)))
        for distance in STARTS_PX:
            for _ in range(TURNS):
                found.ends[distance].append(land.searched(distance * land.direction(rng)))
    return found


def rising(values: Params) -> int:
    """Steps from the first value that all go up."""
    falls = np.flatnonzero(~(np.diff(values) > 0.0))
    return int(falls[0]) if len(falls) else len(values) - 1


def cost(metrics: Mapping[str, Metric]) -> dict[str, tuple[float, float]]:
    """Processor milliseconds of a value, and of value and slope, on frames of 640 x 512; taken in turns."""
    pair = visual_thermal(1, (512, 640), thermal_shape=(512, 640))
    fixed, moving = (np.asarray(image.values, np.float64).ravel() for image in (pair.fixed, pair.moving))
    blank = Pairs(fixed, moving, np.ones_like(fixed), pair.fixed.range(), pair.moving.range(), (512, 640))
    ready = {
        name: Pairs(
            fixed,
            moving,
            blank.weight,
            *(blank.fixed_range, blank.moving_range),
            blank.shape,
            m.prepare(blank),
        )
        for name, m in metrics.items()
    }
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in metrics}
    for _ in range(6):
        for name, metric in metrics.items():
            ticks = [process_time()]
            for call in (metric.value, metric.value_and_derivative):
                call(ready[name])
                ticks.append(process_time())
            times[name].append((ticks[1] - ticks[0], ticks[2] - ticks[1]))
    return {name: tuple(1e3 * np.median(np.array(all_[1:]), axis=0)) for name, all_ in times.items()}


def table(cases: list[Case], names: list[str]) -> str:
    """The comparison in Markdown."""
    metrics = {name: METRICS.build(METRIC[name]) for name in names}
    costs = cost(metrics)
    heads = [
        "metric",
        "optimum off, px",
        "of lines within 3 px",
        "capture, px",
        *(f"from {distance:g} px" for distance in (0.0, *STARTS_PX)),
        "value, ms",
        "with slope, ms",
    ]
    rows = [heads, ["---"] * len(heads)]
    for name, metric in metrics.items():
        found = measure(metric, cases)
        good = [np.mean(np.array(ends) < GOOD_PX) for ends in found.ends.values()]
        rows.append(
            [
                f"`{name}`" if name in METRICS.names() else name,
                f"{np.median(found.off):.1f}",
                f"{np.mean(np.array(found.off) < GOOD_PX):.0%}",
                f"{np.median(found.capture):.0f}",
                *(f"{share:.0%}" for share in good),
                *(f"{time:.1f}" for time in costs[name]),
            ]
        )
        sys.stderr.write(" | ".join(rows[-1]) + "\n")
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def main(arguments: list[str] | None = None) -> None:
    """Compare, and print or write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=8, help="no more than so many")
    parser.add_argument("--metrics", nargs="+", choices=METRIC, default=list(METRIC))
    parser.add_argument("--write", action="store_true", help=f"into {PAGE.name}")
    asked = parser.parse_args(arguments)
    cases = list(each(REACH, most=asked.scenes))
    kind = "real pairs (RoadScene)" if real() else "phantoms"
    text = f"{len(cases)} {kind}:\n\n{table(cases, asked.metrics)}\n"
    sys.stdout.write(text)
    if asked.write:
        put(PAGE, "multimodal", text)


if __name__ == "__main__":
    main()
