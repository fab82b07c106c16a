"""The one decorator for compiled kernels, and what the compiler cannot do by itself.

Rules for a kernel: arrays and scalars in, arrays out; at most ten arguments; it calls only functions of
its own module and takes no constant from another (the cache of compiled code is checked against the
kernel's own file alone). Unsigned
array subscripts spare the test for negative ones and are worth 1.5x in the hot loops.
"""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any, Protocol, TypeVar, cast

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

Array = NDArray[np.float64]
Four = tuple[float, float, float, float]
F = TypeVar("F", bound=Callable[..., Any])
LONG = ir.IntType(64)
FOUR, EIGHT = (ir.VectorType(ir.FloatType(), lanes) for lanes in (4, 8))


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
def _blend_channels(_: Any, moving: Any, width: Any, y: Any, x: Any) -> Any:
    """The four numbers of a flat array of points at a place, see `_between`, as a tuple."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        where = _where(context, builder, signature, arguments)
        m, _, _ = _between(builder, partial(where, 0), *arguments[1:])
        lanes = [builder.extract_element(m, ir.IntType(32)(lane)) for lane in range(4)]
        return context.make_tuple(builder, signature.return_type, lanes)

    return numba.types.UniTuple(numba.float32, 4)(moving, width, y, x), generate


@intrinsic
def _meet_channels(_: Any, sums: Any, fixed: Any, moving: Any, width: Any, way: Any, run: Any) -> Any:
    """Add a run of points' shares to what a correlation of channels is made of, four float32 lanes at once.

    Of both flat arrays a point is four neighbours: three channels and a weight. For `way` and `run` see
    `_each`, for the moving ones, whose rows are `width` numbers long, `_between`. With w the product of both
    weights, `sums` gains w f, w m, w f m, w f f and w m m, four lanes each; the last lane of the first is
    the mass.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        where = _where(context, builder, signature, arguments)
        with _each(builder, partial(where, 0), 5, arguments[4:]) as (add, at, y, x, _):
            m, _, _ = _between(builder, partial(where, 2), arguments[3], y, x)
            f, w = _weighed(builder, where(1, at, FOUR), m)
            f = builder.insert_element(f, ir.Constant(ir.FloatType(), 1.0), ir.IntType(32)(3))
            wf, wm = builder.fmul(w, f), builder.fmul(w, m)
            add(wf, wm, builder.fmul(wf, m), builder.fmul(wf, f), builder.fmul(wm, m))
        return context.get_dummy_value()

    return numba.void(sums, fixed, moving, width, way, run), generate


@intrinsic
def _pull_channels(
    _: Any, sums: Any, fixed: Any, moving: Any, width: Any, way: Any, run: Any, shares: Any
) -> Any:
    """Add a run of points' shares to the slopes of a correlation of channels by the points' places.

    Points as for `_meet_channels`. `shares` holds four lanes each of by_f, by_m and a mean; with the force
    w (by_f f + by_m m - mean), `sums` gains force dm/dy, force dm/dx, and both times the column.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        where = _where(context, builder, signature, arguments)
        by_f, by_m, mean = (builder.load(where(6, LONG(4 * i), FOUR), align=4) for i in range(3))
        with _each(builder, partial(where, 0), 4, arguments[4:]) as (add, at, y, x, column):
            m, down, along = _between(builder, partial(where, 2), arguments[3], y, x)
            f, w = _weighed(builder, where(1, at, FOUR), m)
            force = builder.fadd(builder.fmul(by_f, f), builder.fmul(by_m, m))
            force = builder.fmul(w, builder.fsub(force, mean))
            down, along = builder.fmul(force, down), builder.fmul(force, along)
            lever = _lanes(builder, builder.sitofp(column, ir.FloatType()), 4)
            add(down, along, builder.fmul(lever, down), builder.fmul(lever, along))
        return context.get_dummy_value()

    return numba.void(sums, fixed, moving, width, way, run, shares), generate


@contextmanager
def _each(builder: Any, sums: Callable[..., Any], count: int, given: Any) -> Iterator[tuple[Any, ...]]:
    """A loop along a row: what adds `count` vectors to the sums, then a point's place, y, x and column.

    Of what is given, the first is y and x where the row begins and their steps, as `_between` takes them;
    the second the first column, the one after the last, and where in the fixed array the row begins. The
    sums live in registers meanwhile.
    """
    (y, x, down, along), (first, last, row) = (cgutils.unpack_tuple(builder, one) for one in given[:2])
    places = [cgutils.alloca_once_value(builder, one) for one in (y, x)]
    totals = [cgutils.alloca_once(builder, FOUR) for _ in range(count)]
    for i, total in enumerate(totals):
        builder.store(builder.load(sums(LONG(4 * i), FOUR), align=4), total)

    def add(*parts: Any) -> None:
        for total, part in zip(totals, parts, strict=True):
            builder.store(builder.fadd(builder.load(total), part), total)

    with cgutils.for_range_slice(builder, first, last, LONG(1)) as (column, _):
        here = [builder.load(place) for place in places]
        yield add, builder.add(row, builder.shl(column, LONG(2))), *here, column
        for place, at, step in zip(places, here, (down, along), strict=True):
            builder.store(builder.add(at, step), place)
    for i, total in enumerate(totals):
        builder.store(builder.load(total), sums(LONG(4 * i), FOUR), align=4)


def _between(builder: Any, array: Callable[..., Any], width: Any, y: Any, x: Any) -> tuple[Any, Any, Any]:
    """Four lanes between the points of a flat array, and their slopes along y and x.

    y and x count in 2^-32 of a point, as integers: beside floating point that spares a third of the time of
    `_meet_channels`. Both neighbours of a row are one vector of eight.
    """

    def rest(place: Any) -> Any:
        low = builder.lshr(builder.trunc(place, ir.IntType(32)), ir.IntType(32)(1))
        return builder.fmul(builder.sitofp(low, ir.FloatType()), ir.Constant(ir.FloatType(), 2.0**-31))

    row, column = (builder.ashr(place, LONG(32)) for place in (y, x))
    first = builder.add(builder.mul(row, width), builder.shl(column, LONG(2)))
    above, below = (builder.load(array(at, EIGHT), align=4) for at in (first, builder.add(first, width)))
    down = builder.fsub(below, above)
    met = builder.fadd(above, builder.fmul(down, _lanes(builder, rest(y), 8)))
    (left, right), (falls, rises) = (
        [builder.shuffle_vector(both, both, _numbers(range(k, k + 4))) for k in (0, 4)]
        for both in (met, down)
    )
    along, tx = builder.fsub(right, left), _lanes(builder, rest(x), 4)
    fall = builder.fadd(falls, builder.fmul(builder.fsub(rises, falls), tx))
    return builder.fadd(left, builder.fmul(along, tx)), fall, along


def _weighed(builder: Any, place: Any, m: Any) -> tuple[Any, Any]:
    """Fixed lanes, and the product of both weights as four lanes."""
    f = builder.load(place, align=4)
    both = builder.fmul(f, m)
    return f, builder.shuffle_vector(both, both, _numbers([3] * 4))


def _lanes(builder: Any, number: Any, count: int) -> Any:
    """A vector of so many times the same number."""
    vector = ir.Constant(ir.VectorType(number.type, count), ir.Undefined)
    vector = builder.insert_element(vector, number, ir.IntType(32)(0))
    return builder.shuffle_vector(vector, vector, _numbers([0] * count))


def _numbers(lanes: Iterable[int]) -> Any:
    numbers = list(lanes)
    return ir.Constant(ir.VectorType(ir.IntType(32), len(numbers)), numbers)


def _where(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """What gives the address of an item, or of a vector of neighbours, in one of an intrinsic's arrays."""

    def where(which: int, index: Any, kind: Any) -> Any:
        data = context.make_array(signature.args[which])(context, builder, arguments[which]).data
        return builder.bitcast(builder.gep(data, [index]), kind.as_pointer())

    return where


def _shuffled(builder: Any, first: Any, second: Any, lanes: tuple[int, ...]) -> Any:
    """Lanes of two vectors, those of the second counted on."""
    return builder.shuffle_vector(first, second, _numbers(lanes))


# To numba these are the functions above; to the type checker, what kernels may call.
prefetch = cast("Callable[[Array, int], None]", _prefetch)
columns = cast("Callable[[Array, int, int, Four], Four]", _columns)
blend = cast("Callable[[Array, int, Array, Array, int, int, int, Array, Array], None]", _blend)
meet_channels = cast("Callable[..., None]", _meet_channels)
blend_channels = cast("Callable[..., tuple[float, float, float, float]]", _blend_channels)
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
