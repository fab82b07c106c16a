"""Work that threads share."""

import threading

import pytest

from regframe.kernels.sharing import share


@pytest.fixture(autouse=True)
def three_threads(monkeypatch):
    monkeypatch.setenv("REGFRAME_THREADS", "3")


@pytest.mark.parametrize("count", [0, 1, 2, 3, 10])
def test_every_item_is_worked_once(count):
    done = []

    share(lambda first, last, given: done.extend(range(first, last)) or given, count, "given")

    assert sorted(done) == list(range(count))


def test_all_parts_run_at_once():
    together = threading.Barrier(3, timeout=10.0)

    share(lambda *_: together.wait(), 3)

    assert together.n_waiting == 0


@pytest.mark.parametrize("wrong", [0, 1, 2])
def test_an_error_of_any_part_is_raised_and_the_next_work_is_done(wrong):
    def fail(first, _):
        if first == wrong:
            raise ValueError(first)

    with pytest.raises(ValueError, match=str(wrong)):
        share(fail, 3)

    test_every_item_is_worked_once(10)


def test_work_within_work_is_not_cut_again():
    parts = []

    def outer(first, _):
        share(lambda a, b: parts.append((first, a, b)), 3)

    share(outer, 3)

    assert sorted(parts) == [(0, 0, 3), (1, 0, 3), (2, 0, 3)]
