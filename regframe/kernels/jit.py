"""The one decorator for compiled kernels, and the one way to share their work among threads.

Rules for a kernel: arrays and scalars in, arrays out; at most ten arguments; it calls only functions of
its own module and takes no constant from another (the cache of compiled code is checked against the
kernel's own file alone). Unsigned
array subscripts spare the test for negative ones and are worth 1.5x in the hot loops.
"""

import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any, TypeVar, cast

import numba

BLOCKS = 8
"""Reductions are cut into this many parts, whatever the number of threads, and summed in order."""


F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """Compile on first call, keep on disk, release the lock; no fast-math, so bits are the source's."""
    return cast("F", numba.njit(cache=True, nogil=True, error_model="numpy")(function))


def threads() -> int:
    """Number of threads: ``REGFRAME_THREADS`` where set, else the processors this process may use."""
    wish = os.environ.get("REGFRAME_THREADS", "")
    if wish.isdigit() and int(wish) > 0:
        return int(wish)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _Here(threading.local):
    """Whether this thread is at work on a part already."""

    sharing = False


_here = _Here()


@cache
def _pool(size: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(size, thread_name_prefix="regframe")


if hasattr(os, "register_at_fork"):
    # A forked child inherits the pool's record but none of its threads; it must build its own.
    os.register_at_fork(after_in_child=_pool.cache_clear)


def share(function: Callable[..., object], count: int, *arguments: Any) -> None:
    """Call ``function(first, last, *arguments)`` on parts of ``range(count)``, one a thread.

    Results must not depend on the cut: a kernel writes each item to its own place. For sums, let `count`
    be `BLOCKS` and give every block its own partial sum.
    """
    parts = min(threads(), count)
    if parts <= 1 or _here.sharing:
        # Work within shared work is not shared again: all threads are busy, and might wait for each other.
        function(0, count, *arguments)
        return
    edges = [count * i // parts for i in range(parts + 1)]
    waiting = [
        _pool(parts - 1).submit(_part, function, edges[i], edges[i + 1], *arguments) for i in range(1, parts)
    ]
    _part(function, edges[0], edges[1], *arguments)
    for one in waiting:
        one.result()


def _part(function: Callable[..., object], first: int, last: int, *arguments: Any) -> None:
    _here.sharing = True
    try:
        function(first, last, *arguments)
    finally:
        _here.sharing = False
