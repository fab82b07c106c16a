"""The cross-check as files: a page that loads nothing, its figure, and the numbers."""

import json
from base64 import b64encode
from collections.abc import Sequence
from html import escape
from math import isfinite
from pathlib import Path, PurePath

from regframe.errors import OutputError
from regframe.io import atomic, refuse_existing
from regframe.peer.figures import png
from regframe.peer.report import FILES, FLOORS, Line, Report

STYLE = """
body {font: 15px/1.5 sans-serif; color: #222; max-width: 1150px; margin: 2em auto; padding: 0 1em}
h1 {font-size: 1.5em; margin-bottom: 0.2em} h2 {font-size: 1.15em; margin: 1.8em 0 0.3em}
table {border-collapse: collapse; width: 100%} td, th {text-align: left; padding: 3px 12px 3px 0;
vertical-align: top; border-bottom: 1px solid #eee} th {font-weight: 600}
img {max-width: 100%} .small {color: #555; font-size: 0.9em}
.banner {padding: 0.7em 1em; border-radius: 6px; font-size: 1.1em; margin: 1em 0}
.good {background: #e3f2e6} .bad {background: #fbe3d6}
.agrees {color: #1a7431} .differs {color: #b33c00; font-weight: 700} .not {color: #666}
"""

SHOWN = {"native": "regframe", "simpleitk": "SimpleITK"}

INTRODUCTION = """
<p>regframe and SimpleITK are two programs that align images, written independently. Here they were
given the same two images and the same instructions (the preset <b>{preset}</b>, seed {seed}), and asked
the same questions. Where they agree, a programming error in either is unlikely; where they differ, the
first line that differs tells which part to look at. <b>{fixed}</b> stayed, <b>{moving}</b> was brought
onto it.</p>
"""

READING = """
<p class="small">Blue is regframe, orange is SimpleITK; where the circles sit on the line, both compute
the same. The upper plots move one parameter of the found map at a time and ask both for the metric: a
valley at 0 says that the answer is a best place. Below, both searches run from the same start: on the
left what they gain, on the right how far apart their maps are. Levels of the pyramid are shaded in
turn.</p>
"""


def save(report: Report, folder: Path, *, force: bool = False) -> Path:
    """Write the page, its figure and the numbers.

    Raises
    ------
    OutputError
    """
    check(folder, force=force)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"the output folder {str(folder)!r} cannot be made: {error.strerror}. Name another folder."
        raise OutputError(message) from error
    picture = png(report)
    text = json.dumps(_finite(report.record()), indent=2, allow_nan=False) + "\n"
    contents = (html(report, picture).encode(), picture, text.encode())
    for name, content in zip(FILES, contents, strict=True):
        with atomic(folder / name) as temporary:
            temporary.write_bytes(content)
    return folder


def check(folder: Path, *, force: bool = False) -> None:
    """Refuse a folder that holds an earlier report; looks, and changes nothing.

    Raises
    ------
    OutputError
    """
    for name in FILES:
        refuse_existing(folder / name, force)


def html(report: Report, picture: bytes) -> str:
    """A self-contained page."""
    title = f"Cross-check: {escape(report.preset.name)}"
    kind = "good" if report.agrees else "bad"
    names = {
        key: escape(PurePath(text).name) for key, text in (("fixed", report.fixed), ("moving", report.moving))
    }
    introduction = INTRODUCTION.format(preset=escape(report.preset.name), seed=report.preset.seed, **names)
    inline = b64encode(picture).decode("ascii")
    parts = [
        f"<h1>{title}</h1>",
        f'<div class="banner {kind}">{escape(report.verdict())}</div>',
        introduction,
        f'<img alt="both metrics along each parameter, and both runs" src="data:image/png;base64,{inline}">',
        READING,
        *(_floor(report, floor) for floor in FLOORS),
        _scores(report),
        _notes(report),
        _versions(report),
    ]
    head = f'<meta charset="utf-8"><title>{title}</title><style>{STYLE}</style>'
    body = "\n".join(part for part in parts if part)
    return f'<!doctype html>\n<html lang="en"><head>{head}</head><body>\n{body}\n</body></html>\n'


def _floor(report: Report, floor: str) -> str:
    rows = [
        (escape(line.what), _verdict(line), _tolerance(line), escape(line.why))
        for line in report.lines
        if line.floor == floor
    ]
    told = next(text for name, text in FLOORS.items() if name == floor)
    table = _table(("compared", "verdict", "allowed", "what else"), rows)
    return f'<h2>{floor.capitalize()}</h2><div class="small">{escape(told)}</div>{table}'


def _verdict(line: Line) -> str:
    return f'<span class="{line.verdict}">{escape(line.told())}</span>'


def _tolerance(line: Line) -> str:
    if line.tolerance is None:
        return ""
    return f"{line.tolerance:g} {escape(line.unit)}"


def _scores(report: Report) -> str:
    if not report.scores:
        return ""
    rows = [
        (f"answer of {SHOWN[who]}", *(f"{value:.12g}" for value in values.values()), _seconds(report, who))
        for who, values in report.scores.items()
    ]
    judges = [f"by the metric of {SHOWN[name]}" for name in next(iter(report.scores.values()))]
    return f"<h2>Answers scored by both metrics</h2>{_table(('', *judges, 'run took'), rows)}"


def _seconds(report: Report, who: str) -> str:
    return f"{report.seconds[who]:.2f} s" if who in report.seconds else ""


def _notes(report: Report) -> str:
    if not report.notes:
        return ""
    items = "".join(f"<li>{escape(note)}</li>" for note in report.notes)
    return (
        "<h2>Said otherwise</h2>"
        '<div class="small">Where SimpleITK has no word for what the preset says, both engines were told '
        f"the nearest thing it has; see docs/explanation/agreement.md.</div><ul>{items}</ul>"
    )


def _versions(report: Report) -> str:
    told = ", ".join(f"{name} {version}" for name, version in report.versions.items())
    return f'<h2>Versions</h2><p class="small">{escape(told)}</p>'


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    top = "".join(f"<th>{cell}</th>" for cell in head)
    body = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><tr>{top}</tr>{body}</table>"


def _finite(tree: object) -> object:
    if isinstance(tree, dict):
        return {key: _finite(value) for key, value in tree.items()}
    if isinstance(tree, list | tuple):
        return [_finite(value) for value in tree]
    return None if isinstance(tree, float) and not isfinite(tree) else tree
