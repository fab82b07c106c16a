"""Damaged TIFF directories end in an error of ours, never in another."""

from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from regframe.errors import ImageError
from regframe.io.tiff import plan
from support.tiffs import PHOTOMETRIC, tiff, tiled

FRAME = np.arange(42, dtype=np.uint16).reshape(6, 7)
FILES = {
    "pages": tiff([FRAME, FRAME]),
    "big, the other byte order": tiff([FRAME], {PHOTOMETRIC: None}, ">", big=True),
    "tiles": tiled(FRAME.astype(np.float64)),
}


@pytest.mark.parametrize("kind", FILES)
@given(data=st.data())
def test_a_changed_file_is_planned_or_refused(kind, data):
    stored = bytearray(FILES[kind])
    places = st.integers(0, len(stored) - 1)
    for place, value in data.draw(st.lists(st.tuples(places, st.integers(0, 255)), max_size=8)):
        stored[place] = value
    length = data.draw(st.integers(16, len(stored)))

    with suppress(ImageError):
        plan(bytes(stored[:length]), "frame")
