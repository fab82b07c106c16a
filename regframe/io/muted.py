"""What compiled libraries print, kept off the terminal."""

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from threading import Lock

_ONE_AT_A_TIME = Lock()


@contextmanager
def muted() -> Iterator[list[str]]:
    """Collect what C and C++ code prints in the block; the list is filled when the block ends.

    ITK, libjpeg, libtiff and HDF5 tell of odd files on standard error or standard output and nowhere
    else: a truncated JPEG is read without an error. Threads take turns, or one of them would restore what
    another had replaced.

    Examples
    --------
    >>> with muted() as said:
    ...     _ = os.write(2, b"Premature end of JPEG file")
    >>> said
    ['Premature end of JPEG file']
    """
    said: list[str] = []
    with _ONE_AT_A_TIME, tempfile.TemporaryFile() as sink:
        kept = _redirect(sink.fileno())
        try:
            yield said
        finally:
            for stream, copy in kept.items():
                os.dup2(copy, stream)
                os.close(copy)
            sink.seek(0)
            said += sink.read().decode(errors="replace").splitlines()


def _redirect(target: int) -> dict[int, int]:
    """Send standard output and error to `target`; copies of what they were, for those that are open."""
    kept = {}
    for number, stream in ((1, sys.stdout), (2, sys.stderr)):
        with suppress(OSError, ValueError):
            if stream is not None:
                stream.flush()
            kept[number] = os.dup(number)
            os.dup2(target, number)
    return kept
