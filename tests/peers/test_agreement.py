"""The standing report on agreement lists every component and still holds."""

import re

import pytest

from house.source import REPOSITORY
from regframe.catalog import INTERPOLATORS, METRICS, OPTIMIZERS, TRANSFORMS
from regframe.peer import settings
from regframe.peer.agreement import NONE, Row, rows

PAGE = REPOSITORY / "docs" / "explanation" / "agreement.md"
LINE = re.compile(r"^\| `(?P<name>[^`]+)` \| (?P<cells>.+) \|$", re.MULTILINE)
SHIPPED = [
    name
    for registry in (METRICS, TRANSFORMS, INTERPOLATORS, OPTIMIZERS)
    for name in registry.names()
    if registry.origin(name) == "regframe"
]
EXACT = 1e-12  # what is equal in every bit here may not be with another library of sines


@pytest.fixture(scope="module")
def written():
    text = PAGE.read_text(encoding="utf-8").partition("## Every component")[2]
    return {found["name"]: re.split(r"(?<!\\)\| ", found["cells"]) for found in LINE.finditer(text)}


@pytest.fixture(scope="module")
def measured():
    return {row.name: row for row in rows()}


@pytest.mark.parametrize("name", SHIPPED)
def test_a_component_has_a_line_without_an_empty_cell(name, written):
    assert name in written, "run `make docs`"
    assert len(written[name]) == 4
    assert all(cell.strip() for cell in written[name])


@pytest.mark.slow
@pytest.mark.parametrize("name", SHIPPED)
def test_the_line_is_true(name, written, measured):
    twin, way, within, relation = (cell.strip() for cell in written[name])
    row = measured[name]

    assert (twin, way, relation) == (row.twin, row.way, row.relation), "run `make docs`"
    # A decade is left to other machines.
    assert row.within is None or row.within <= 10 * promised(within)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHIPPED)
def test_what_has_a_twin_agrees_with_it(name, measured):
    row = measured[name]
    loosest = 1e-7 if row.way != "answers only: the walks are not alike" else 0.1

    assert row.twin == NONE or row.within <= loosest


@pytest.fixture(scope="module")
def set_up():
    return {row.name: row for row in settings.rows()}


@pytest.mark.slow
def test_a_setting_has_a_line_that_is_true(written, set_up):
    for name, row in set_up.items():
        assert name in written, "run `make docs`"
        twin, way, within, relation = (cell.strip() for cell in written[name])
        assert (twin, way, relation) == (row.twin, row.way, row.relation), "run `make docs`"
        assert row.within is not None
        assert row.within <= min(10 * promised(within), 1e-9)


def test_no_cell_of_the_page_is_empty():
    """Departures from ITK and how to ask for its way, what is said otherwise, and every component."""
    tables = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("|")]

    assert len(tables) > 60
    for line in tables:
        cells = re.split(r"(?<!\\)\|", line)[1:-1]
        assert all(cell.strip() for cell in cells), line


def promised(cell):
    return EXACT if cell == "equal bits" else max(float(cell.split()[0]), EXACT)


def test_bounds_are_powers_of_ten():
    assert Row("a", "b", "c", 3.2e-13, "px", "d").bound() == "1e-12 px"
    assert Row("a", "b", "c", 0.0, "px", "d").bound() == "equal bits"
    assert Row("a", "b", "c", None, "", "d").bound() == "not compared"
