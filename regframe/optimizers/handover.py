"""A search that calls us, turned into a generator: it runs on a thread of its own, in turns with ours."""

from collections.abc import Callable, Generator
from queue import SimpleQueue
from threading import Thread
from typing import NamedTuple

from regframe.types import Params

Cost = Callable[[Params], tuple[float, Params]]
Report = Callable[[Params, float], None]
Search = Callable[[Cost, Report], str]
Measured = tuple[float, Params]


class Reached(NamedTuple):
    """Where a search stands after one of its iterations."""

    at: Params
    value: float


def turns(search: Search, cost: Cost) -> Generator[Reached, None, str]:
    """Yield each report of a search, and return what it returns.

    One of the two threads always waits for the other, and `cost` is called on the caller's thread only, so
    nothing depends on timing. When the generator is closed the search is ended at its next call.

    Parameters
    ----------
    search : callable
        Takes a cost to call and a report to make after each iteration; returns why it stopped.
    cost : callable
        From a position to value and slope; what it raises, this raises.

    Examples
    --------
    >>> import numpy as np
    >>> def halve(cost, report):
    ...     for at in (np.array([4.0]), np.array([2.0])):
    ...         report(at, cost(at)[0])
    ...     return "near enough"
    >>> [reached.value for reached in turns(halve, lambda at: (float(at @ at), 2.0 * at))]
    [16.0, 4.0]
    """
    talk = _Talk()
    thread = Thread(target=talk.run, args=(search,), daemon=True)
    thread.start()
    try:
        while True:
            told = talk.news.get()
            if isinstance(told, _Question):
                talk.answers.put(cost(told.at))
            elif isinstance(told, Reached):
                yield told
                talk.answers.put((told.value, told.at))
            elif isinstance(told, str):
                return told
            else:
                raise told
    finally:
        talk.answers.put(_HangUp())
        thread.join()


class _Question(NamedTuple):
    at: Params


class _HangUp(Exception):
    """Ends a search in the middle of its call."""


class _Talk:
    """What the search's thread says, and what it is answered."""

    def __init__(self) -> None:
        self.news: SimpleQueue[_Question | Reached | str | Exception] = SimpleQueue()
        self.answers: SimpleQueue[Measured | _HangUp] = SimpleQueue()

    def run(self, search: Search) -> None:
        """The search, on its own thread."""
        try:
            self.news.put(search(self.cost, self.report))
        except _HangUp:
            return
        except Exception as error:
            # Raised again on the caller's thread, whatever it is.
            self.news.put(error)

    def cost(self, at: Params) -> Measured:
        """Value and slope, measured on the caller's thread."""
        return self._ask(_Question(at.copy()))

    def report(self, at: Params, value: float) -> None:
        """Tell of an iteration, and wait until the next one is wanted."""
        self._ask(Reached(at.copy(), value))

    def _ask(self, what: _Question | Reached) -> Measured:
        self.news.put(what)
        answer = self.answers.get()
        if isinstance(answer, _HangUp):
            raise answer
        return answer
