"""Homographies and lenses on genuine unaligned pairs, beside the similarity that they began from.

``pytest -m slow tests/benchmarks/lenses.py -s`` prints the table, in a quarter
of an hour; its name keeps it out of the other runs. Errors are mean distances from the
ground truth in thermal pixels. The floor is the least that any similarity leaves. A pair whose similarity is
more than max(5, floor + 3) pixels off was lost by the search: it stands in the table and in the medians, but
a homography or a lens is not blamed for it.
"""

import statistics

import pytest

from regframe import register
from regframe.catalog import TRANSFORMS
from support.raw_pairs import raw_pairs

pytestmark = pytest.mark.slow

SOURCES = ("roadscene_raw", "metu_vistir_raw")
PRESETS = {
    "similarity": "visual-thermal",
    "projective": "visual-thermal-projective",
    "radial": "visual-thermal-radial",
}
GAIN = 0.25  # share of the median floor that the median error must lie below it
HARM = 0.3  # thermal pixels by which no pair may be worse than its similarity


@pytest.fixture(scope="module")
def table(data):
    """Of each pair its source, its floor, its error by each preset, and what was kept."""
    rows = []
    for pair in raw_pairs(data, SOURCES):
        errors, kept = {}, []
        for name, preset in PRESETS.items():
            result = register(preset, pair.fixed, pair.moving)
            errors[name] = pair.error(result.warp)
            kept += [
                f"{TRANSFORMS.name_of(result.preset.stages[choice.stage].transform)} "
                f"{'kept' if choice.kept else 'not kept'} ({choice.reason})"
                for choice in result.choices[-1:]
            ]
        rows.append((pair.name, pair.source, pair.floor, errors, kept))
    return rows


def test_prints_the_table(table, capsys):
    with capsys.disabled():
        print(f"\n{'pair':28}{'floor':>8}" + "".join(f"{name:>12}" for name in PRESETS))
        for name, _, floor, errors, kept in table:
            cells = "".join(f"{errors[one]:12.2f}" for one in PRESETS)
            print(f"{name[-27:]:28}{floor:8.2f}{cells}  {'; '.join(kept)}")
        for source in (*SOURCES, "all"):
            rows = [row for row in table if source in (row[1], "all")]
            cells = "".join(f"{statistics.median(row[3][one] for row in rows):12.2f}" for one in PRESETS)
            print(f"{'median of ' + source:28}{statistics.median(row[2] for row in rows):8.2f}{cells}")

    assert len(table) == 16


@pytest.mark.parametrize("name", ["projective", "radial"])
def test_no_pair_is_harmed(name, table):
    found = [row for row in table if row[3]["similarity"] < max(5.0, row[2] + 3.0)]
    harm = {row[0]: row[3][name] - row[3]["similarity"] for row in found}

    assert max(harm.values()) <= HARM, harm


def test_lenses_bring_the_median_well_below_the_floor(table):
    floor = statistics.median(row[2] for row in table)

    assert statistics.median(row[3]["radial"] for row in table) <= (1 - GAIN) * floor
