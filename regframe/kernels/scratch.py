"""Arrays that a thread uses again and again: fresh memory costs as much as a pass of sums over it."""

import threading
from collections.abc import Callable

import numpy as np

from regframe.types import Volume

New = Callable[[str, tuple[int, ...]], Volume]
"""Gives an array of a shape, its contents unset, under a name."""

MOST = 2**22
"""Numbers in the largest array that is kept."""


class _Kept(threading.local):
    def __init__(self) -> None:
        self.blocks: dict[str, Volume] = {}


_kept = _Kept()


def fresh(_: str, shape: tuple[int, ...]) -> Volume:
    """An array of its own."""
    return np.empty(shape)


def scratch(name: str, shape: tuple[int, ...]) -> Volume:
    """One array a thread and a name: it holds until the thread asks for that name again.

    Examples
    --------
    >>> scratch("example", (2, 3)).base is scratch("example", (3, 1)).base
    True
    """
    size = int(np.prod(shape))
    if size > MOST:
        return np.empty(shape)
    block = _kept.blocks.get(name)
    if block is None or block.size < size:
        block = _kept.blocks[name] = np.empty(size)
    return block[:size].reshape(shape)
