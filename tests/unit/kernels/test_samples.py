"""Kernels made of a formula do what the formula does sample by sample, in Python."""

import subprocess
import sys

import numpy as np
import pytest

from regframe.kernels import per_sample

COUNT = 1003  # not a multiple of the blocks


@per_sample
def penalty(fixed, moving, weight, scale):
    square = ((fixed - moving) / scale) ** 2
    return weight * square / (1.0 + square), weight


@per_sample
def slope(fixed, moving, scale):
    return 2.0 * (moving - fixed) / scale


@per_sample
def by_class(fixed, moving, weight, classes):
    return np.floor(fixed * classes), weight, weight * moving


@per_sample
def words(fixed):
    return "text" if fixed > 0 else "other"


@per_sample
def unknown(fixed):
    return object(fixed)


@pytest.fixture
def samples():
    rng = np.random.default_rng(3)
    fixed, moving = rng.uniform(-0.2, 1.2, (2, COUNT))
    return fixed, moving, (rng.random(COUNT) > 0.2).astype(np.float64)


def test_total_is_the_sum_of_the_formula(samples):
    slow = np.array([penalty.function(*one, 0.3) for one in zip(*samples, strict=True)])

    # Sums of a thousand terms in another order.
    assert penalty.total(*samples, 0.3) == pytest.approx(slow.sum(axis=0), rel=1e-13)


def test_each_is_the_formula_sample_by_sample(samples):
    (found,) = slope.each(*samples[:2], 0.3)

    slow = [slope.function(*one, 0.3) for one in zip(*samples[:2], strict=True)]
    assert np.array_equal(found, slow)


def test_bins_add_up_by_bin_and_leave_out_what_has_none(samples):
    mass, sums = by_class.bins(7, *samples, 7.0)

    slow = np.zeros((2, 7))
    for one in zip(*samples, strict=True):
        bin_, weight, moved = by_class.function(*one, 7.0)
        if 0 <= bin_ < 7:
            slow[:, int(bin_)] += weight, moved
    assert mass == pytest.approx(slow[0], rel=1e-13)
    assert sums == pytest.approx(slow[1], rel=1e-13)


def test_a_bin_that_is_no_number_is_left_out(samples):
    fixed = np.full(COUNT, np.nan)

    mass, _ = by_class.bins(7, fixed, *samples[1:], 7.0)

    assert mass.sum() == 0.0


@pytest.mark.parametrize("threads", ["1", "2", "3", "8"])
def test_the_number_of_threads_changes_no_bit(threads, samples, monkeypatch):
    monkeypatch.setenv("REGFRAME_THREADS", "1")
    alone = penalty.total(*samples, 0.3), by_class.bins(7, *samples, 7.0)
    monkeypatch.setenv("REGFRAME_THREADS", threads)

    together = penalty.total(*samples, 0.3), by_class.bins(7, *samples, 7.0)

    assert together[0] == alone[0]
    assert np.array_equal(together[1], alone[1])


def test_no_samples_make_nothing():
    empty = np.zeros(0)

    assert penalty.total(empty, empty, empty, 0.3) == (0.0, 0.0)
    assert slope.each(empty, empty, 0.3)[0].shape == (0,)
    assert by_class.bins(4, empty, empty, empty, 7.0)[0].tolist() == [0.0] * 4


def test_other_numbers_are_taken_as_float64(samples):
    fixed, moving, weight = samples

    single = penalty.total(fixed[::2], moving[::2], weight[::2].astype(np.int32), 1)

    assert single == penalty.total(fixed[::2].copy(), moving[::2].copy(), weight[::2].copy(), 1.0)


@pytest.mark.parametrize(
    ("arguments", "words_told"),
    [
        ((1.0, 2.0, 3.0, 4.0), "at least one. Got shapes none"),
        ((np.zeros(3), np.zeros(4), 1.0, 1.0), "Got shapes (3,) and (4,)"),
        ((np.zeros((2, 2)), 1.0, 1.0, 1.0), "Got shapes (2, 2)"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(arguments, words_told):
    with pytest.raises(TypeError) as caught:
        penalty.total(*arguments)

    assert words_told in str(caught.value)


def test_a_formula_that_returns_no_number_is_told():
    with pytest.raises(
        TypeError, match=r"words must return a number or a tuple of numbers\. Got unicode_type"
    ):
        words.each(np.ones(3))


def test_a_formula_that_cannot_be_compiled_is_told():
    with pytest.raises(TypeError, match="unknown cannot be compiled for 1 numbers"):
        unknown.each(np.ones(3))


def test_bins_without_anything_to_add_are_refused():
    with pytest.raises(TypeError, match="needs a bin and numbers to add"):
        slope.bins(3, np.ones(3), np.ones(3), 1.0)


@pytest.mark.slow
def test_a_second_process_finds_the_compiled_loop(tmp_path):
    (tmp_path / "mine.py").write_text(
        "import numpy as np\n"
        "from regframe.kernels import per_sample\n"
        "@per_sample\n"
        "def twice(fixed):\n"
        "    return 2.0 * fixed\n"
        "print(twice.total(np.ones(3)))\n"
        "for loop, _ in twice._loops.values():\n"
        "    print(sum(loop.stats.cache_hits.values()), sum(loop.stats.cache_misses.values()))\n"
    )

    said = [
        subprocess.run([sys.executable, "mine.py"], cwd=tmp_path, capture_output=True, text=True, check=True)
        for _ in range(2)
    ]

    assert [one.stdout.split("\n")[:2] for one in said] == [["(6.0,)", "0 1"], ["(6.0,)", "1 0"]]
