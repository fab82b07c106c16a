"""What a cross-check found: a line a comparison, the curves behind them, and the verdict."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from math import isfinite
from pathlib import Path
from typing import Any, Literal

from regframe.preset import Preset

Verdict = Literal["agrees", "differs", "not comparable"]
Floor = Literal["components", "pairs", "whole run"]

FLOORS: Mapping[Floor, str] = {
    "components": "each part by itself, at the answer: the same question put to both engines",
    "pairs": "intensities read by SimpleITK, judged by regframe's metric: needs no twin of the metric",
    "whole run": "the same start, seed and levels in both engines, from the first step to the answer",
}
FILES = ("crosscheck.html", "crosscheck.png", "crosscheck.json")


@dataclass(frozen=True)
class Line:
    """One comparison.

    Parameters
    ----------
    floor : str
    what : str
        What was compared.
    verdict : str
    difference, tolerance : float, optional
        The largest difference met and the largest that still agrees, in `unit`.
    unit : str
    why : str
        Why it cannot be compared, or what else to know.
    """

    floor: Floor
    what: str
    verdict: Verdict
    difference: float | None = None
    tolerance: float | None = None
    unit: str = ""
    why: str = ""

    def told(self) -> str:
        """The verdict in a few words.

        Examples
        --------
        >>> measured("pairs", "metric", 0.25, 1e-7, "of the value").told()
        'differs by 0.25 of the value'
        """
        if self.difference is None:
            return self.verdict
        amount = f"{self.difference:.2g}{' ' if self.unit else ''}{self.unit}"
        if self.difference == 0.0:
            return "agrees exactly"
        return f"agrees to {amount}" if self.verdict == "agrees" else f"differs by {amount}"


def measured(
    floor: Floor, what: str, difference: float, tolerance: float, unit: str, *, why: str = ""
) -> Line:
    """A line that agrees where a difference is within its tolerance; what is no number differs."""
    verdict: Verdict = "agrees" if difference <= tolerance else "differs"
    return Line(floor, what, verdict, float(difference), tolerance, unit, why)


def incomparable(floor: Floor, what: str, why: str) -> Line:
    """A line that tells why nothing could be compared."""
    return Line(floor, what, "not comparable", why=why)


@dataclass(frozen=True)
class Sweep:
    """Both metrics while one parameter alone moves through the answer.

    Parameters
    ----------
    name : str
        The parameter's.
    motion : tuple of float
        How far its change moves the image, pixels (or mm).
    native, simpleitk : tuple of float
        Metric values, lower is better; infinite where nothing overlaps.
    """

    name: str
    motion: tuple[float, ...]
    native: tuple[float, ...]
    simpleitk: tuple[float, ...]


@dataclass(frozen=True)
class Course:
    """Both runs, iteration by iteration.

    Parameters
    ----------
    native, simpleitk : tuple of float
        Metric values as each optimizer reports them.
    apart : tuple of float
        Largest distance between both maps over the fixed image's corners, pixels (or mm).
    levels : tuple of int
        Iteration at which each level begins.
    """

    native: tuple[float, ...]
    simpleitk: tuple[float, ...]
    apart: tuple[float, ...]
    levels: tuple[int, ...]


@dataclass(frozen=True)
class Report:
    """A cross-check of one preset on one pair.

    Parameters
    ----------
    preset : Preset
    fixed, moving : str
        Names of the images.
    unit : str
        ``px`` for camera frames, else ``mm``.
    lines : tuple of Line
    sweeps : tuple of Sweep
    course : Course, optional
    corner : float, optional
        How far apart both answers take the fixed image's corners; none where there was one run only.
    scores : mapping
        Each answer's value by each engine's metric.
    seconds : mapping
        How long each engine took.
    notes : tuple of str
        What had to be told to SimpleITK otherwise than the preset says.
    versions : mapping
    """

    preset: Preset
    fixed: str
    moving: str
    unit: str
    lines: tuple[Line, ...]
    sweeps: tuple[Sweep, ...] = ()
    course: Course | None = None
    corner: float | None = None
    scores: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)

    @property
    def agrees(self) -> bool:
        """Whether nothing differs; what cannot be compared does not count."""
        return not any(line.verdict == "differs" for line in self.lines)

    def fails(self, above: float) -> bool:
        """Whether answers are farther apart than a bound, or a part before the whole run differs."""
        parts = any(line.verdict == "differs" and line.floor != "whole run" for line in self.lines)
        return parts or (self.corner is not None and not self.corner <= above)

    def verdict(self) -> str:
        """The outcome in a sentence."""
        counts = [(sum(line.verdict == word for line in self.lines), *said) for word, said in _WORDS.items()]
        told = ", ".join(f"{count} {one if count == 1 else more}" for count, one, more in counts if count)
        if self.corner is None:
            ends = "There is no whole run to compare"
        elif self.corner == 0.0:
            ends = "Both engines end at exactly the same map"
        else:
            ends = f"Both engines end {self.corner:.2g} {self.unit} apart"
        return f"{ends}. Of {len(self.lines)} comparisons, {told}."

    def record(self) -> dict[str, Any]:
        """The report as a tree of JSON values."""
        return {
            "agrees": self.agrees,
            "verdict": self.verdict(),
            "corner": self.corner,
            "unit": self.unit,
            "preset": self.preset.name,
            "seed": self.preset.seed,
            "fixed": self.fixed,
            "moving": self.moving,
            "lines": [asdict(line) for line in self.lines],
            "scores": {who: dict(values) for who, values in self.scores.items()},
            "seconds": dict(self.seconds),
            "notes": list(self.notes),
            "versions": dict(self.versions),
            "sweeps": [asdict(sweep) for sweep in self.sweeps],
            "course": None if self.course is None else asdict(self.course),
        }

    def save(self, folder: str | Path, *, force: bool = False) -> Path:
        """Write a page, its figure and the numbers into a folder, which is made if missing.

        Raises
        ------
        OutputError
            The folder cannot be written, or holds an earlier report and `force` is off.
        """
        from regframe.peer.page import save  # draws, so it loads matplotlib

        return save(self, Path(folder), force=force)


_WORDS: Mapping[Verdict, tuple[str, str]] = {
    "agrees": ("agrees", "agree"),
    "differs": ("differs", "differ"),
    "not comparable": ("cannot be made", "cannot be made"),
}
"""What one comparison does, and what several do."""


def largest(differences: Iterable[float]) -> float:
    """The largest of some differences; infinite where one is no finite number.

    Examples
    --------
    >>> largest([0.25, float("nan")])
    inf
    """
    known = [float(one) for one in differences]
    return max(known, default=0.0) if all(map(isfinite, known)) else float("inf")
