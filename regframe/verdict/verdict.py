"""The verdict on a result: one word, two numbers, and the reasons."""

from math import isfinite
from typing import TYPE_CHECKING, Any, Literal, final

from regframe.engine.native import filtered
from regframe.verdict import backward, calibration
from regframe.verdict.evidence import NEAR_PX, Evidence, gather, round_trip

if TYPE_CHECKING:
    from regframe.engine.base import Result

Word = Literal["good", "doubtful", "failed", "unjudged"]


@final
class Verdict(str):
    """Whether to trust a map: ``good``, ``doubtful``, ``failed``, or ``unjudged`` where no calibration holds.

    A verdict is its word, so ``result.verdict == "good"`` asks it.

    Parameters
    ----------
    word : str
    probability : float or None
        Of a mean error within 5 moving pixels.
    expected_error_px : float or None
        Expected mean error, in moving pixels.
    evidence : Evidence or None
        The numbers behind it; None in 3-D.
    reasons : tuple of str
        The same in sentences, or why nothing is said.

    Examples
    --------
    >>> verdict = Verdict("unjudged", reasons=("no runs on volumes were calibrated",))
    >>> verdict == "failed", verdict.probability
    (False, None)
    """

    probability: float | None
    expected_error_px: float | None
    evidence: Evidence | None
    reasons: tuple[str, ...]

    def __new__(
        cls,
        word: Word,
        *,
        probability: float | None = None,
        expected_error_px: float | None = None,
        evidence: Evidence | None = None,
        reasons: tuple[str, ...] = (),
    ) -> "Verdict":
        """A word with what it rests on."""
        made = str.__new__(cls, word)
        made.probability = probability
        made.expected_error_px = expected_error_px
        made.evidence = evidence
        made.reasons = reasons
        return made

    def __repr__(self) -> str:
        """The word and its numbers, as one would write them."""
        numbers = f"probability={self.probability}, expected_error_px={self.expected_error_px}"
        return f"Verdict({str(self)!r}, {numbers})"

    def record(self) -> dict[str, Any]:
        """What ``result.json`` holds of it."""
        return {
            "verdict": str(self),
            "probability_within_5_px": self.probability,
            "expected_error_px": self.expected_error_px,
            "evidence": None if self.evidence is None else self.evidence.record(),
            "reasons": list(self.reasons),
        }

    def summary(self) -> str:
        """The word and its numbers in one line."""
        if self.probability is None:
            return f"{self}: {self.reasons[0]}"
        share = min(max(round(100 * self.probability), 1), 99)
        said = f"{self}: within {NEAR_PX:g} px with a probability of {share} %"
        return f"{said}, expected error {self.expected_error_px:.1f} px" if self != "failed" else said


def judge(result: "Result") -> Verdict:
    """The verdict on a result.

    Where a calibration holds, the preset also searches from the moving to the fixed image, which takes about
    as long as the registration did.

    Parameters
    ----------
    result : Result
    """
    excuse = calibration.excuse(result)
    if result.fixed.dim != 2:
        return Verdict("unjudged", reasons=(excuse,))
    found = evidence(result, search_back=not excuse and backward.searches(result.preset))
    if excuse:
        return Verdict("unjudged", evidence=found, reasons=(excuse, *reasons(found)))
    probability = calibration.probability(found)
    return Verdict(
        word(probability),
        probability=probability,
        expected_error_px=calibration.expected_error_px(found),
        evidence=found,
        reasons=reasons(found),
    )


def evidence(result: "Result", *, search_back: bool) -> Evidence:
    """The evidence on a result in 2-D.

    Parameters
    ----------
    result : Result
    search_back : bool
        Also search from the moving to the fixed image, which takes nearly all of the time.
    """
    apart = None
    if search_back:
        back = backward.search(result)
        apart = round_trip(result.warp, back, result.fixed.grid, result.moving.grid)
    images = filtered(result.preset, result.fixed, result.moving)
    return gather(*images, result.warp, round_trip_px=apart)


def word(probability: float) -> Word:
    """The word for a probability of being near."""
    if probability >= calibration.GOOD:
        return "good"
    return "failed" if probability < calibration.FAILED else "doubtful"


def reasons(found: Evidence) -> tuple[str, ...]:
    """What the evidence says, a sentence each."""
    return tuple(filter(None, (_round_trip(found), _parts(found), _rival(found), _overlap(found))))


def _round_trip(found: Evidence) -> str:
    apart = found.round_trip_px
    if apart is None:
        return ""
    if not isfinite(apart):
        return "A second search, from the moving to the fixed image, found nothing."
    agrees = "confirms the map" if apart <= NEAR_PX else "contradicts the map"
    return f"A second search, from the moving to the fixed image, {agrees}: {apart:.1f} px apart."


def _parts(found: Evidence) -> str:
    if not found.parts:
        return "No part of the image is covered by both images well enough to be looked at by itself."
    parts = f"Fitted one by one, {found.parts} parts of the image"
    share = f"{100 * found.parts_near:.0f} % of their edges within {NEAR_PX:g} px of the map"
    return f"{parts} have {share}, typically {found.leftover_px:.1f} px off."


def _rival(found: Evidence) -> str:
    if found.edge_fit <= 0.0:
        return "Edges coincide no more than by chance."
    if found.rival >= 1.0:
        return f"Edges fit {found.rival:.1f} times as well with the moving image shifted elsewhere."
    return f"Shifted elsewhere, edges fit at most {100 * found.rival:.0f} % as well as here."


def _overlap(found: Evidence) -> str:
    return f"Both images show {100 * found.overlap:.0f} % of the smaller field of view."
