"""The one way to share work among threads."""

import os
import threading
from collections.abc import Callable
from functools import cache
from queue import SimpleQueue
from typing import Any

BLOCKS = 8
"""Reductions are cut into this many parts, whatever the number of threads, and summed in order."""


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


class _Part:
    """One thread's part of shared work."""

    def __init__(self, function: Callable[..., object], first: int, last: int, arguments: Any) -> None:
        self._call = function, first, last, arguments
        self._error: BaseException | None = None
        self._busy = threading.Lock()
        self._busy.acquire()

    def run(self) -> None:
        """Do it; an error waits for the one who asked."""
        function, first, last, arguments = self._call
        _here.sharing = True
        try:
            function(first, last, *arguments)
        except BaseException as error:
            self._error = error
        finally:
            _here.sharing = False
            self._busy.release()

    def wait(self) -> None:
        """Return when it is done, or raise its error."""
        self._busy.acquire()
        if self._error is not None:
            raise self._error


@cache
def _pool(size: int) -> SimpleQueue[_Part]:
    """A queue that as many threads serve: half the price of an executor, which counts where work is short."""
    queue: SimpleQueue[_Part] = SimpleQueue()
    for i in range(size):
        threading.Thread(target=_serve, args=(queue,), name=f"regframe_{i}", daemon=True).start()
    return queue


def _serve(queue: SimpleQueue[_Part]) -> None:
    while True:
        queue.get().run()


if hasattr(os, "register_at_fork"):
    # A forked child inherits the pool's record but none of its threads; it must build its own.
    os.register_at_fork(after_in_child=_pool.cache_clear)


def share(function: Callable[..., object], count: int, *arguments: Any) -> None:
    """Call ``function(first, last, *arguments)`` on parts of ``range(count)``, one a thread.

    Results must not depend on the cut: a kernel writes each item to its own place. For sums, let `count`
    be `BLOCKS` and give every block its own partial sum.
    """
    parts = 1 if _here.sharing else min(threads(), count)
    if parts <= 1:
        # Work within shared work is not shared again: all threads are busy, and might wait for each other.
        function(0, count, *arguments)
        return
    edges = [count * i // parts for i in range(parts + 1)]
    work = [_Part(function, edges[i], edges[i + 1], arguments) for i in range(parts)]
    for part in work[1:]:
        _pool(parts - 1).put(part)
    work[0].run()
    for part in work:
        part.wait()
