"""A blocking call with callbacks as a generator of what its callbacks tell."""

from collections.abc import Callable, Generator
from queue import SimpleQueue
from threading import Event, Semaphore, Thread
from typing import Generic, TypeVar

T = TypeVar("T")

PATIENCE = 10.0
"""Seconds that a call which was told to stop may take to do so before it is left to itself."""


class Teller(Generic[T]):
    """What a callback tells through; the call waits until the teller's reader asks for more."""

    def __init__(self) -> None:
        self.queue: SimpleQueue[tuple[T | None, BaseException | None]] = SimpleQueue()
        self.turn = Semaphore(0)
        self.stopped = Event()

    def __call__(self, item: T) -> bool:
        """Hand an item over; whether to go on."""
        if not self.stopped.is_set():
            self.queue.put((item, None))
            self.turn.acquire()
        return not self.stopped.is_set()


def lockstep(call: Callable[[Teller[T]], None]) -> Generator[T, None, None]:
    """Yield each item that `call` tells, which runs on a thread of its own only while the next is awaited.

    So a caller that stops asking, or is interrupted, stops the call at its next item; and its errors are
    raised where items are asked for.

    Examples
    --------
    >>> def count(tell):
    ...     for n in range(10):
    ...         if not tell(n):
    ...             break
    >>> [n for n, _ in zip(lockstep(count), range(3))]
    [0, 1, 2]
    """
    teller: Teller[T] = Teller()

    def run() -> None:
        try:
            call(teller)
        except BaseException as error:  # every error belongs to the thread that waits for this one
            teller.queue.put((None, error))
        else:
            teller.queue.put((None, StopIteration()))

    worker = Thread(target=run, name="regframe-simpleitk", daemon=True)
    worker.start()
    try:
        while True:
            item, end = teller.queue.get()
            if isinstance(end, StopIteration):
                return
            if end is not None:
                raise end
            yield item  # type: ignore[misc]  # an entry without an end holds an item
            teller.turn.release()
    finally:
        teller.stopped.set()
        teller.turn.release()
        worker.join(PATIENCE)
