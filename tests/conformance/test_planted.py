"""Each planted fault is caught by the check that is there for it, with a message that names it."""

import pytest
from conformance import planted

from regframe.testing import verify

FAULTS = [
    (planted.WrongSign, "derivative matches differences", "`derivative` is not the slope of `value`"),
    (planted.Rusher, "carried features stand for the image", "The slope of carried features is not that of"),
    (planted.Stranger, "carried features stand for the image", "carried features give another value"),
    (planted.Gambler, "is deterministic", "Two calls with the same pairs differ"),
    (planted.Gambler, "keeps no state", "gives something else after other inputs"),
    (planted.Writer, "leaves its input alone", "`value` writes into pairs.moving. Copy before changing."),
    (planted.Tally, "keeps no state", "Using it changes conformance.planted.CALLS: global state"),
    (planted.Diarist, "keeps no state", "Using it changes conformance.planted.LOG: global state"),
    (planted.Marker, "keeps no state", "Using it changes Marker.last: global state"),
    (planted.Homesick, "is the same in a new process", "A new process gives other values"),
    (planted.Undefined, "survives constant images", "A constant moving image gives nan"),
    (planted.Claimant, "holds its invariances", "`invariant_to` names 'shift', but on a mono pair"),
    (planted.Inventor, "holds its invariances", "`invariant_to` may name shift, scale, inversion, monotone"),
    (planted.Careless, "batch order does not matter", "takes float64 rows, (b, 4). Got float32"),
    (planted.Blender, "batch order does not matter", "The walk changes when the rows of a batch"),
    (planted.Stretcher, "gives finite values", "Guard the division by its range"),
]


@pytest.mark.parametrize(
    ("faulty", "check", "words"), FAULTS, ids=[f"{faulty.__name__}-{check}" for faulty, check, _ in FAULTS]
)
def test_a_planted_fault_is_named(faulty, check, words):
    found = {verdict.name: verdict.message for verdict in verify(faulty()) if not verdict.passed}

    assert words in found[check]


def test_a_class_that_a_new_process_cannot_import_is_no_fault():
    class Local(planted.Difference):
        """Defined in a function (nobody, 1999)."""

    Local.__module__ = "no_such_module"
    from regframe.testing.worker import Answer, _answer

    assert isinstance(_answer(b"not a pickle", 1), Answer)
    assert _answer(b"not a pickle", 1).unknown
