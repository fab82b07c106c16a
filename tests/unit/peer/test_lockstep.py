"""Blocking calls as generators."""

import threading
import time

import pytest

from regframe.peer.lockstep import lockstep


def counting(limit, log):
    def call(tell):
        for n in range(limit):
            log.append(n)
            if not tell(n):
                log.append("told to stop")
                return

    return call


def test_yields_what_the_call_tells():
    assert list(lockstep(counting(4, []))) == [0, 1, 2, 3]


def test_the_call_runs_only_while_the_next_item_is_awaited():
    log = []
    items = lockstep(counting(9, log))

    next(items)
    time.sleep(0.02)

    assert log == [0]
    items.close()


def test_closing_tells_the_call_to_stop():
    log = []
    items = lockstep(counting(9, log))
    next(items)

    items.close()

    assert log == [0, "told to stop"]
    assert not any(thread.name == "regframe-simpleitk" for thread in threading.enumerate())


def test_an_error_of_the_call_is_raised_where_items_are_asked_for():
    def call(tell):
        tell(1)
        message = "odd"
        raise ValueError(message)

    items = lockstep(call)
    assert next(items) == 1

    with pytest.raises(ValueError, match="odd"):
        next(items)
