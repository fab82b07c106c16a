"""A second Python process that builds components anew and tells what they do there.

One process serves every check of this one, so that its start (a few seconds) is paid once. It is a plain
child with pipes: multiprocessing would run the caller's main script again.
"""

import atexit
import os
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from pickle import dump, dumps, load, loads
from threading import Lock

from regframe import plugins
from regframe.component import Component
from regframe.testing.observation import Seen, observe

COMMAND = "from regframe.testing.worker import serve; serve()"


@dataclass(frozen=True)
class Answer:
    """What the other process saw, or why it saw nothing.

    Parameters
    ----------
    seen : list of arrays or None
        What `observe` gave there.
    unknown : str
        Why the component could not be made there.
    failed : str
        What was raised when it was used.
    """

    seen: Seen | None = None
    unknown: str = ""
    failed: str = ""


class Worker:
    """A child process that answers one question at a time."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._child = subprocess.Popen(
            [sys.executable, "-c", COMMAND], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        atexit.register(self.close)

    def ask(self, component: Component, seed: int) -> Answer:
        """What `observe` gives there.

        Raises
        ------
        OSError, EOFError
            The process has ended.
        """
        question = (sys.path, plugins.files(), dumps(component), seed)
        assert self._child.stdin is not None
        assert self._child.stdout is not None
        with self._lock:
            dump(question, self._child.stdin)
            self._child.stdin.flush()
            answer: Answer = load(self._child.stdout)
        return answer

    def close(self) -> None:
        """End the process."""
        # It ends by itself when nobody can ask any more.
        self._child.communicate()


@cache
def worker() -> Worker:
    """The one worker of this process, started when first asked for."""
    return Worker()


def serve() -> None:
    """Answer questions from the input until it ends; prints of components go to the error stream."""
    replies = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while True:
        try:
            path, files, pickled, seed = load(sys.stdin.buffer)
        except EOFError:
            return
        sys.path[:] = path
        for file in files:
            plugins.load(file)  # each time: it may have been changed since
        dump(_answer(pickled, seed), replies)
        replies.flush()


def _answer(pickled: bytes, seed: int) -> Answer:
    # Code that nobody has tried may raise anything; whatever it is belongs into the answer.
    try:
        component = loads(pickled)
    except Exception as error:
        return Answer(unknown=f"{type(error).__name__}: {error}")
    try:
        return Answer(observe(component, seed))
    except Exception as error:
        return Answer(failed=f"{type(error).__name__}: {error}")
