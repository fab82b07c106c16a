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
from typing import Any, Protocol, TypeVar, cast

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

BLOCKS = 8
"""Reductions are cut into this many parts, whatever the number of threads, and summed in order."""


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


# To numba these are the functions above; to the type checker, what kernels may call.
prefetch = cast("Callable[[NDArray[np.float64], int], None]", _prefetch)
columns = cast("Callable[[NDArray[np.float64], int, int, Four], Four]", _columns)


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
