"""Homographies and lenses on genuine unaligned pairs, beside the similarity that they began from.

``pytest -m slow tests/benchmarks/lenses.py -s`` prints the tables, in some minutes; its name keeps it out
of the other runs. Errors are mean distances from the ground truth in thermal pixels. The floor is the least
that any similarity leaves: the root mean square that the data state (rms), and the mean distance, which is
what errors are. A pair whose similarity is more than max(5, floor + 3) pixels off was lost by the search: it
stands in the table and in the medians, but a homography or a lens is not blamed for it.

The second table tells how far such a figure can be trusted: homographies fitted by four unlike metrics, their
distance from the ground truth and from their own mean.
"""

import statistics
from dataclasses import dataclass

import numpy as np
import pytest

from regframe import register
from regframe.catalog import TRANSFORMS
from regframe.preset import load
from regframe.transforms.warp import Warp
from support.raw_pairs import raw_pairs

pytestmark = pytest.mark.slow

SOURCES = ("roadscene_raw", "metu_vistir_raw")
FAMILIES = ("similarity", "affine", "projective", "projective-radial")
GAIN = 0.25  # share of the median floor that the median error must lie below it
HARM = 0.3  # thermal pixels by which no pair may be worse than its similarity
METRICS = ("oriented-gradients", "mind-ssc", "normalised-gradient-fields")


@dataclass(frozen=True)
class Row:
    """A pair, the similarity that was found, its floors, the error by each family, and what was kept."""

    pair: object
    similarity: Warp
    floors: tuple[float, float]
    errors: dict[str, float]
    kept: tuple[str, ...]

    @property
    def found(self):
        return self.errors["similarity"] < max(5.0, self.floors[0] + 3.0)

    def harm(self, family):
        return self.errors[family] - self.errors["similarity"]


@pytest.fixture(scope="module")
def table(data):
    """Of each pair a Row."""
    return [_row(pair) for pair in raw_pairs(data, SOURCES)]


def _row(pair):
    """One run of the radial preset tells three answers: its stages are those of the other two."""
    radial = register("visual-thermal-radial", pair.fixed, pair.moving)
    affine = register("visual-thermal-affine", pair.fixed, pair.moving)
    found = [_end_of(radial, stage) for stage in range(3)]
    after = found[1] if radial.choices[0].kept else found[0]
    warps = (found[0], affine.warp, after, radial.warp)
    kept = tuple(_told(result, choice) for result in (affine, radial) for choice in result.choices)
    errors = {name: pair.error(warp) for name, warp in zip(FAMILIES, warps, strict=True)}
    return Row(pair, found[0], (pair.floor, _least(pair)), errors, kept)


def _end_of(result, stage):
    last = [report for report in result.levels if report.stage == stage][-1]
    return Warp(result.preset.stages[stage].transform, np.array(last.params), last.frame)


def _told(result, choice):
    name = TRANSFORMS.name_of(result.preset.stages[choice.stage].transform)
    return f"{name} {'kept' if choice.kept else 'not kept'} ({choice.reason})"


def _least(pair):
    """Mean distance that the similarity nearest to the ground truth leaves."""
    x, y = (pair.seen - pair.seen.mean(axis=0)).T
    one, none = np.ones(len(x)), np.zeros(len(x))
    rows = np.concatenate([np.stack([x, -y, one, none], 1), np.stack([y, x, none, one], 1)])
    wanted = pair.wanted.T.ravel()
    left = rows @ np.linalg.lstsq(rows, wanted, rcond=None)[0] - wanted
    return float(np.hypot(*left.reshape(2, -1)).mean())


def _median(rows, figure):
    return statistics.median(figure(row) for row in rows)


def test_prints_the_table(table, capsys):
    with capsys.disabled():
        heads = ("floor rms", "mean", *FAMILIES)
        print(f"\n{'pair':28}" + "".join(f"{head:>18}" for head in heads))
        for row in table:
            cells = "".join(f"{one:18.2f}" for one in (*row.floors, *row.errors.values()))
            print(f"{row.pair.name[-27:]:28}{cells}  {'; '.join(row.kept)}")
        for source in (*SOURCES, "all"):
            rows = [row for row in table if source in (row.pair.source, "all")]
            middles = [_median(rows, lambda row, i=i: row.floors[i]) for i in range(2)]
            middles += [_median(rows, lambda row, f=family: row.errors[f]) for family in FAMILIES]
            print(f"{'median of ' + source:28}" + "".join(f"{middle:18.2f}" for middle in middles))
        harm = [max(row.harm(family) for row in table if row.found) for family in FAMILIES]
        print(f"{'worst loss to similarity':28}" + " " * 36 + "".join(f"{one:+18.2f}" for one in harm))

    assert len(table) == 16


@pytest.mark.parametrize("family", FAMILIES[1:])
def test_no_pair_is_harmed(family, table):
    harm = {row.pair.name: row.harm(family) for row in table if row.found}

    assert max(harm.values()) <= HARM, harm


def test_lenses_bring_the_median_well_below_the_floor(table):
    floor = _median(table, lambda row: row.floors[1])

    assert _median(table, lambda row: row.errors["projective-radial"]) <= (1 - GAIN) * floor


def test_unlike_metrics_agree_with_each_other_better_than_with_the_ground_truth(table, capsys):
    rows = [row for row in table if row.found and row.pair.source == "roadscene_raw"]
    away, apart = zip(*(_distances(row) for row in rows), strict=True)

    with capsys.disabled():
        print(f"\n{'homographies by metric':28}{'from the truth':>18}{'from their mean':>18}")
        for number, name in enumerate(("visual-thermal's", *METRICS)):
            middles = (statistics.median(pair[number] for pair in one) for one in (away, apart))
            print(f"{name:28}" + "".join(f"{middle:18.2f}" for middle in middles))

    assert 2 * np.median(apart) < np.median(away)


def _distances(row):
    """Mean distance of each metric's homography from the truth and from the mean of all, (2, metrics)."""
    base = load("visual-thermal-projective")
    stage = base.stages[1].model_copy(update={"start": "identity", "proof": None})
    tree, ends = base.model_copy(update={"stages": (stage,)}).model_dump(mode="json"), []
    for metric in (tree["stages"][0]["metric"], *METRICS):
        tree["stages"][0]["metric"] = metric
        ends.append(register(tree, row.pair.fixed, row.pair.moving, start=row.similarity).warp(row.pair.seen))
    return [
        [float(np.linalg.norm(end - to, axis=1).mean()) for end in ends]
        for to in (row.pair.wanted, np.mean(ends, axis=0))
    ]
