"""The one decorator for compiled kernels, and the one way to share their work among threads.

Rules for a kernel: arrays and scalars in, arrays out; at most ten arguments; it calls only functions of
its own module and takes no constant from another (the cache of compiled code is checked against the
kernel's own file alone). Unsigned
array subscripts spare the test for negative ones and are worth 1.5x in the hot loops.
"""

import os
import threading
from collections.abc import Callable
from functools import cache
from queue import SimpleQueue
from typing import Any, Protocol, TypeVar, cast

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

BLOCKS = 8
"""Reductions are cut into this many parts, whatever the number of threads, and summed in order."""


Array = NDArray[np.float64]
Four = tuple[float, float, float, float]
F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """Compile on first call, keep on disk, release the lock; no fast-math, so bits are the source's."""
    return cast("F", numba.njit(cache=True, nogil=True, error_model="numpy")(function))


@intrinsic
def _prefetch(_: Any, array: Any, index: Any) -> Any:
    """Ask for ``array[index]``, one-dimensional, to be brought near; a place outside the array does no harm.

    A map that turns the image reads short pieces of many rows, which the processor does not foresee:
    without asking, the wait for memory is more than half of the time of linear interpolation.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        view = context.make_array(signature.args[0])(context, builder, arguments[0])
        place = builder.bitcast(builder.gep(view.data, [arguments[1]]), cgutils.voidptr_t)
        word = ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [cgutils.voidptr_t, word, word, word])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        builder.call(function, [place, word(0), word(3), word(1)])  # for reading, soon again, data
        return context.get_dummy_value()

    return numba.void(array, index), generate


@intrinsic
def _columns(_: Any, array: Any, index: Any, stride: Any, shares: Any) -> Any:
    """Sums ``shares[j] * array[index + j * stride + i]`` over j, for i from 0 to 3, as a tuple.

    The compiler does not see by itself that four neighbours can be loaded, scaled and added as one; here
    that is worth a third of the time of a spline's slopes. Each sum goes from j = 0 to 3, without fused
    operations, so its bits are those of the formula.
    """
    four = ir.VectorType(ir.DoubleType(), 4)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        view = context.make_array(signature.args[0])(context, builder, arguments[0])
        place, total = arguments[1], None
        for j in range(4):
            start = builder.bitcast(builder.gep(view.data, [place]), four.as_pointer())
            share, row = ir.Constant(four, ir.Undefined), builder.load(start, align=8)
            for lane in range(4):
                one = builder.extract_value(arguments[3], j)
                share = builder.insert_element(share, one, ir.IntType(32)(lane))
            part = builder.fmul(share, row)
            total = part if total is None else builder.fadd(total, part)
            place = builder.add(place, arguments[2])
        lanes = [builder.extract_element(total, ir.IntType(32)(lane)) for lane in range(4)]
        return context.make_tuple(builder, signature.return_type, lanes)

    floats = numba.types.UniTuple(numba.float64, 4)
    return floats(array, index, stride, shares), generate


@intrinsic
def _blend(
    _: Any, out: Any, at: Any, array: Any, places: Any, k: Any, offset: Any, width: Any, tx: Any, ty: Any
) -> Any:
    """Bilinear values at the four samples from `k` on, into `out` from `at` on; all four as one.

    Sample i lies between the corners ``o, o + 1, o + width, o + width + 1`` of `array`, where
    ``o = offset + int(places[i])``, at ``tx[i], ty[i]`` from the first. The compiler cannot do this by
    itself: for all it knows, what is written changes what is read next. Along x first, without fused
    operations: the bits are those of the formula.
    """
    long, pair, four = ir.IntType(64), ir.VectorType(ir.DoubleType(), 2), ir.VectorType(ir.DoubleType(), 4)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        where, k = _where(context, builder, signature, arguments), arguments[4]

        def along(low: Any, high: Any, t: Any) -> Any:
            return builder.fadd(low, builder.fmul(builder.fsub(high, low), t))

        def line(shift: Any) -> Any:
            pairs = [builder.load(where(2, builder.add(o, shift), pair), align=8) for o in corners]
            first, last = (_shuffled(builder, pairs[i], pairs[i + 1], (0, 2, 1, 3)) for i in (0, 2))
            return [_shuffled(builder, first, last, lanes) for lanes in ((0, 1, 4, 5), (2, 3, 6, 7))]

        places = [builder.load(where(3, builder.add(k, long(i)), ir.DoubleType())) for i in range(4)]
        corners = [builder.add(arguments[5], builder.fptosi(place, long)) for place in places]
        tx, ty = (builder.load(where(which, k, four), align=8) for which in (7, 8))
        low, high = (along(corner[0], corner[1], tx) for corner in map(line, (long(0), arguments[6])))
        value = along(low, high, ty)
        builder.store(value, where(0, arguments[1], four), align=8)
        return context.get_dummy_value()

    return numba.void(out, at, array, places, k, offset, width, tx, ty), generate


@intrinsic
def _add_powers(_: Any, array: Any, cells: Any, t: Any, shares: Any, k: Any) -> Any:
    """Add ``shares[i] * t[i]**q`` to ``array[4 * int(cells[i]) + q]``, q from 0 to 3, for four samples.

    The four powers of one sample are added as one, after those of four samples were multiplied as one.
    Samples follow each other, so the bits are those of a loop.
    """
    long, four = ir.IntType(64), ir.VectorType(ir.DoubleType(), 4)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        where, k = _where(context, builder, signature, arguments), arguments[4]
        steps, powers = builder.load(where(2, k, four), align=8), [builder.load(where(3, k, four), align=8)]
        for _ in range(3):
            powers.append(builder.fmul(powers[-1], steps))
        # Turned from powers of four samples to samples of four powers; `halves` holds two samples each.
        halves = [
            [_shuffled(builder, powers[i], powers[i + 1], lanes) for i in (0, 2)]
            for lanes in ((0, 4, 2, 6), (1, 5, 3, 7))
        ]
        for i in range(4):
            lanes = (0, 1, 4, 5) if i < 2 else (2, 3, 6, 7)
            added = _shuffled(builder, halves[i % 2][0], halves[i % 2][1], lanes)
            cell = builder.fptosi(builder.load(where(1, builder.add(k, long(i)), ir.DoubleType())), long)
            place = where(0, builder.shl(cell, long(2)), four)
            builder.store(builder.fadd(builder.load(place, align=8), added), place, align=8)
        return context.get_dummy_value()

    return numba.void(array, cells, t, shares, k), generate


@intrinsic
def _meet_channels(
    _: Any, sums: Any, fixed: Any, at: Any, moving: Any, place: Any, width: Any, tx: Any, ty: Any
) -> Any:
    """Add one point's share to what a correlation of channels is made of, four float32 lanes at once.

    Of both flat arrays a point is four neighbours: three channels and a weight. The moving ones are those
    at `place`, blended with the next point and those `width` further on by `tx, ty`. With w the product of
    both weights, `sums` gains w f, w m, w f m, w f f and w m m, four lanes each; the last lane of the first
    is the mass.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        where = _where(context, builder, signature, arguments)
        f, m, w, _, _ = _met(builder, where, arguments)
        f = builder.insert_element(f, ir.Constant(ir.FloatType(), 1.0), ir.IntType(32)(3))
        wf, wm = builder.fmul(w, f), builder.fmul(w, m)
        parts = (wf, wm, builder.fmul(wf, m), builder.fmul(wf, f), builder.fmul(wm, m))
        _add_lanes(builder, where, parts)
        return context.get_dummy_value()

    return numba.void(sums, fixed, at, moving, place, width, tx, ty), generate


@intrinsic
def _pull_channels(
    _: Any,
    sums: Any,
    fixed: Any,
    at: Any,
    moving: Any,
    place: Any,
    width: Any,
    tx: Any,
    ty: Any,
    shares: Any,
) -> Any:
    """Add one point's share to the slopes of a correlation of channels by the point's place.

    Points as for `_meet_channels`. `shares` holds four lanes each of by_f, by_m and a mean; with the force
    w (by_f f + by_m m - mean), `sums` gains force dm/dy, force dm/dx, and both times the number that follows.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        where = _where(context, builder, signature, arguments)
        f, m, w, down, along = _met(builder, where, arguments)
        by_f, by_m, mean = (builder.load(where(8, ir.IntType(64)(4 * i), FOUR), align=4) for i in range(3))
        force = builder.fadd(builder.fmul(by_f, f), builder.fmul(by_m, m))
        force = builder.fmul(w, builder.fsub(force, mean))
        down, along = builder.fmul(force, down), builder.fmul(force, along)
        lever = _lanes(builder, builder.load(where(8, ir.IntType(64)(12), ir.FloatType())))
        parts = (down, along, builder.fmul(lever, down), builder.fmul(lever, along))
        _add_lanes(builder, where, parts)
        return context.get_dummy_value()

    return numba.void(sums, fixed, at, moving, place, width, tx, ty, shares), generate


FOUR = ir.VectorType(ir.FloatType(), 4)


def _met(builder: Any, where: Any, arguments: Any) -> tuple[Any, Any, Any, Any, Any]:
    """Of one point: fixed lanes, moving lanes, the product of weights, moving slopes along y and x."""
    long = ir.IntType(64)
    f = builder.load(where(1, arguments[2], FOUR), align=4)
    beside = builder.add(arguments[4], long(4))
    corners = []
    for place in (arguments[4], beside):
        for shift in (long(0), arguments[5]):
            corners.append(builder.load(where(3, builder.add(place, shift), FOUR), align=4))
    near, below, right, across = corners
    tx, ty = (_lanes(builder, one) for one in arguments[6:8])
    top_slope, bottom_slope = builder.fsub(right, near), builder.fsub(across, below)
    top = builder.fadd(near, builder.fmul(top_slope, tx))
    down = builder.fsub(builder.fadd(below, builder.fmul(bottom_slope, tx)), top)
    along = builder.fadd(top_slope, builder.fmul(builder.fsub(bottom_slope, top_slope), ty))
    m = builder.fadd(top, builder.fmul(down, ty))
    last = ir.IntType(32)(3)
    weight = builder.fmul(builder.extract_element(f, last), builder.extract_element(m, last))
    return f, m, _lanes(builder, weight), down, along


def _lanes(builder: Any, number: Any) -> Any:
    """A vector of four times the same number."""
    vector = ir.Constant(FOUR, ir.Undefined)
    for lane in range(4):
        vector = builder.insert_element(vector, number, ir.IntType(32)(lane))
    return vector


def _add_lanes(builder: Any, where: Any, parts: tuple[Any, ...]) -> None:
    """Add vectors to the first argument, four numbers each."""
    for i, part in enumerate(parts):
        place = where(0, ir.IntType(64)(4 * i), FOUR)
        builder.store(builder.fadd(builder.load(place, align=4), part), place, align=4)


def _where(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """What gives the address of an item, or of a vector of neighbours, in one of an intrinsic's arrays."""

    def where(which: int, index: Any, kind: Any) -> Any:
        data = context.make_array(signature.args[which])(context, builder, arguments[which]).data
        return builder.bitcast(builder.gep(data, [index]), kind.as_pointer())

    return where


def _shuffled(builder: Any, first: Any, second: Any, lanes: tuple[int, ...]) -> Any:
    """Lanes of two vectors, those of the second counted on."""
    return builder.shuffle_vector(first, second, ir.Constant(ir.VectorType(ir.IntType(32), 4), list(lanes)))


# To numba these are the functions above; to the type checker, what kernels may call.
prefetch = cast("Callable[[Array, int], None]", _prefetch)
columns = cast("Callable[[Array, int, int, Four], Four]", _columns)
blend = cast("Callable[[Array, int, Array, Array, int, int, int, Array, Array], None]", _blend)
meet_channels = cast("Callable[..., None]", _meet_channels)
pull_channels = cast("Callable[..., None]", _pull_channels)
add_powers = cast("Callable[[Array, Array, Array, Array, int], None]", _add_powers)


class Compiled(Protocol):
    """A compiled function."""

    def __call__(self, *arguments: Any) -> Any:
        """What the function does."""


def compiled(function: Callable[..., Any]) -> Compiled:
    """As `kernel`, for functions of others: kept on disk only where their source is a file."""
    try:
        return kernel(function)
    except RuntimeError:
        # numba finds no place for code that was typed into an interpreter.
        return cast("Compiled", numba.njit(nogil=True, error_model="numpy")(function))


def outputs(function: Compiled, count: int) -> int:
    """How many numbers a compiled function of `count` float64 returns in a tuple; 0 for a plain number.

    Raises
    ------
    TypeError
        It cannot be compiled, or returns something else.
    """
    compiler = cast("Any", function)
    signature = (numba.float64,) * count
    try:
        compiler.compile(signature)
    except numba.core.errors.NumbaError as error:
        message = f"{compiler.__name__} cannot be compiled for {count} numbers: {error}"
        raise TypeError(message) from None
    given = compiler.overloads[signature].signature.return_type
    numbers = tuple(given) if isinstance(given, numba.types.BaseTuple) else (given,)
    if not all(isinstance(one, numba.types.Number | numba.types.Boolean) for one in numbers):
        message = f"{compiler.__name__} must return a number or a tuple of numbers. Got {given}."
        raise TypeError(message)
    return len(numbers) if isinstance(given, numba.types.BaseTuple) else 0


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
