"""How the verdict was calibrated: ``python docs/calibration run | table | fit | draw``.

``run`` needs the folder of real images (REGFRAME_DATA) and some hours; it goes on where it was stopped.
``table`` measures the evidence on the maps that were found and writes ``evidence.csv``. ``fit`` fits the
coefficients to that table, prints how well they hold on scenes that were kept back, and writes them into the
package. ``draw`` makes the figures of the page. The last two need nothing but the table.
"""

import argparse
import csv
import json
import os
from pathlib import Path

import fit
from cases import cases, in_turn
from runs import COLUMNS, cells, measure, records, row_of, run

from regframe.preset import load
from regframe.verdict import backward

HERE = Path(__file__).parent
TABLE = HERE / "evidence.csv"
HEAD = ("preset", "kind", "name", "scenes", "error_px", *COLUMNS)


def main() -> None:
    """Do what the command line says."""
    options = _options()
    {"run": _run, "table": _table, "fit": _fit, "draw": _draw}[options.what](options)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=("run", "table", "fit", "draw"))
    parser.add_argument(
        "--data", type=Path, default=os.environ.get("REGFRAME_DATA"), help="folder of real images"
    )
    parser.add_argument(
        "--maps", type=Path, default=Path("maps.jsonl"), help="what runs leave and tables read"
    )
    parser.add_argument("--preset", default="visual-thermal")
    parser.add_argument("--kinds", default="", help="run only these, a comma between them")
    parser.add_argument("--times", type=int, default=2, help="warps of each scene and level")
    parser.add_argument("--part", default="0/1", help="run every n-th case: 0/2 and 1/2 together are all")
    return parser.parse_args()


def _run(options: argparse.Namespace) -> None:
    done = {(record["preset"], record["kind"], record["name"]) for record in records(options.maps)}
    part, parts = map(int, options.part.split("/"))
    back = backward.searches(load(options.preset))
    for number, case in enumerate(in_turn(cases(options.data, options.times))):
        wanted = not options.kinds or case.kind in options.kinds.split(",")
        if wanted and number % parts == part and (options.preset, case.kind, case.name) not in done:
            record = run(case, options.preset, back=back)
            with options.maps.open("a", encoding="utf-8") as file:
                file.write(json.dumps(record) + "\n")


def _table(options: argparse.Namespace) -> None:
    known = {(case.kind, case.name): case for case in cases(options.data, options.times)}
    rows = []
    for record in records(options.maps):
        case = known.get((record["kind"], record["name"]))
        if case is not None and "map" in record:
            rows += map(cells, measure(record, case))
    with TABLE.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD, *sorted(rows)])
    print(f"{len(rows)} rows in {TABLE}")


def _rows() -> list:
    with TABLE.open(encoding="utf-8", newline="") as file:
        return [row_of(cells) for cells in list(csv.reader(file))[1:]]


def _fit(_: argparse.Namespace) -> None:
    rows = _rows()
    print(fit.report(rows))
    fit.write(fit.everything(rows))


def _draw(_: argparse.Namespace) -> None:
    import figures

    figures.draw(_rows(), HERE.parent / "images")


if __name__ == "__main__":
    main()
