"""A formula for one sample becomes a kernel for all: threaded, the same bits on any number of threads."""

import inspect
import re
from collections.abc import Callable, Sequence
from typing import final

import numpy as np
from numpy.typing import NDArray

from regframe.kernels.jit import Compiled, compiled, outputs
from regframe.kernels.sharing import BLOCKS, share
from regframe.types import Values

Argument = NDArray[np.float64] | float

# A name a loop, a name a column; what the formula returns is `met`.
EACH = """
def {name}(first, last, {parameters}, columns):
    for block in range(first, last):
        for i in range(len({first_array}) * block // {blocks}, len({first_array}) * (block + 1) // {blocks}):
            met = formula({call})
            {store}
"""
TOTAL = """
def {name}(first, last, {parameters}, columns):
    for block in range(first, last):
        {zeros}
        for i in range(len({first_array}) * block // {blocks}, len({first_array}) * (block + 1) // {blocks}):
            met = formula({call})
            {add}
        {store}
"""
BINS = """
def {name}(first, last, {parameters}, columns):
    for block in range(first, last):
        columns[block] = 0.0
        for i in range(len({first_array}) * block // {blocks}, len({first_array}) * (block + 1) // {blocks}):
            met = formula({call})
            bin = int(met[0])
            if 0 <= bin < columns.shape[1]:
                {add}
"""


@final
class SampleKernel:
    """What `per_sample` makes of a function of one sample.

    Arguments are given as the function names them: an array, (n,), gives each sample its own number, a plain
    number is the same for all. Everything is float64.
    """

    def __init__(self, function: Callable[..., object]) -> None:
        self.function = function
        self._formula = compiled(function)
        self._loops: dict[tuple[str, tuple[bool, ...]], tuple[Compiled, int]] = {}

    def total(self, *arguments: Argument) -> tuple[float, ...]:
        """The sum over all samples of each number that the function returns.

        Blocks of samples are summed by themselves and their sums added in order, so the number of threads
        changes no bit.

        Examples
        --------
        >>> @per_sample
        ... def squared(fixed, moving, weight):
        ...     return weight * (fixed - moving) ** 2, weight
        >>> squared.total(np.array([1.0, 2.0]), np.array([1.0, 5.0]), np.array([1.0, 0.5]))
        (4.5, 1.5)
        """
        given, count = _given(arguments)
        loop, width = self._loop("total", given)
        columns = np.zeros((BLOCKS, max(width, 1)))
        if count:
            share(loop, BLOCKS, *given, columns)
        totals = columns[0].copy()
        for row in columns[1:]:
            totals += row
        return tuple(map(float, totals))

    def each(self, *arguments: Argument) -> tuple[Values, ...]:
        """Every number that the function returns, an array of all samples each, (n,).

        Examples
        --------
        >>> @per_sample
        ... def slope(fixed, moving, factor):
        ...     return factor * (moving - fixed)
        >>> slope.each(np.array([1.0, 2.0]), np.array([1.0, 5.0]), 2.0)
        (array([0., 6.]),)
        """
        given, count = _given(arguments)
        loop, width = self._loop("each", given)
        columns = np.empty((max(width, 1), count))
        if count:
            share(loop, BLOCKS, *given, columns)
        return tuple(columns)

    def bins(self, count: int, *arguments: Argument) -> tuple[Values, ...]:
        """Sums by bin: the function returns a sample's bin, then the numbers to add there; (count,) each.

        The bin is a whole number. A sample whose bin is not in ``range(count)`` is left out.

        Examples
        --------
        >>> @per_sample
        ... def sums(fixed, moving, weight):
        ...     return fixed, weight, weight * moving
        >>> sums.bins(3, np.array([0.0, 2.0, 2.9]), np.array([5.0, 1.0, 3.0]), np.ones(3))
        (array([1., 0., 2.]), array([5., 0., 4.]))
        """
        given, samples = _given(arguments)
        if outputs(self._formula, len(given)) < 2:
            message = f"`bins` needs a bin and numbers to add. {self.function.__name__} returns one number."
            raise TypeError(message)
        loop, width = self._loop("bins", given)
        columns = np.zeros((BLOCKS, count, width - 1))
        if samples:
            share(loop, BLOCKS, *given, columns)
        sums = columns[0].copy()
        for block in columns[1:]:
            sums += block
        return tuple(np.ascontiguousarray(sums.T))

    def _loop(self, way: str, given: Sequence[Argument]) -> tuple[Compiled, int]:
        """The loop for this way of use, made when it is first needed."""
        arrays = tuple(isinstance(one, np.ndarray) for one in given)
        if (way, arrays) not in self._loops:
            width = outputs(self._formula, len(given))
            self._loops[way, arrays] = (self._written(way, arrays, width), width)
        return self._loops[way, arrays]

    def _written(self, way: str, arrays: tuple[bool, ...], width: int) -> Compiled:
        """A loop about the formula, as source that stands in the function's own file.

        numba keeps compiled code on disk beside a file and for as long as that file stays as it is; so a loop
        that belongs to the author's file is compiled once, and anew when the file changes.
        """
        names = [f"a{i}" for i in range(len(arrays))]
        met = [f"met[{k}]" for k in range(width)] if width else ["met"]
        forms = {
            "each": (EACH, "", "", [f"columns[{k}, i] = {one}" for k, one in enumerate(met)]),
            "total": (
                TOTAL,
                [f"s{k} = 0.0" for k, _ in enumerate(met)],
                [f"s{k} += {one}" for k, one in enumerate(met)],
                [f"columns[block, {k}] = s{k}" for k, _ in enumerate(met)],
            ),
            "bins": (BINS, "", [f"columns[block, bin, {k}] += {one}" for k, one in enumerate(met[1:])], ""),
        }
        template, zeros, add, store = forms[way]
        marks = "".join("a" if array else "n" for array in arrays)
        name = f"{re.sub(r'[^A-Za-z0-9_]', '_', self.function.__qualname__)}__{way}_{marks}_{width}"
        source = template.format(
            name=name,
            parameters=", ".join(names),
            first_array=names[arrays.index(True)],
            blocks=BLOCKS,
            call=", ".join(f"{one}[i]" if array else one for one, array in zip(names, arrays, strict=True)),
            zeros="; ".join(zeros),
            add="; ".join(add),
            store="; ".join(store),
        )
        space = {"__name__": self.function.__module__, "formula": self._formula}
        exec(compile(source, _file(self.function), "exec"), space)
        return compiled(space[name])


def per_sample(function: Callable[..., object]) -> SampleKernel:
    """Decorate a function of one sample's numbers, written in plain Python, to run it over all samples.

    The function takes numbers and returns a number or a tuple of numbers. It is compiled when it is first
    called; of modules it may use `math` and numpy's scalar functions.

    Parameters
    ----------
    function : callable
        At module level, with positional parameters alone.

    Returns
    -------
    SampleKernel
        ``total`` sums over samples, ``each`` gives arrays, ``bins`` sums by bin.

    Examples
    --------
    >>> @per_sample
    ... def robust(fixed, moving, weight, scale):
    ...     square = ((fixed - moving) / scale) ** 2
    ...     return weight * square / (1.0 + square)
    >>> robust.total(np.array([1.0, 2.0]), np.array([1.0, 4.0]), np.ones(2), 2.0)
    (0.5,)
    """
    return SampleKernel(function)


def _given(arguments: Sequence[Argument]) -> tuple[list[Argument], int]:
    """Arguments as float64, and the number of samples.

    Raises
    ------
    TypeError
        There is no array, or arrays differ in length.
    """
    given = [
        np.ascontiguousarray(one, np.float64) if isinstance(one, np.ndarray) else float(one)
        for one in arguments
    ]
    shapes = sorted({one.shape for one in given if isinstance(one, np.ndarray)})
    if len(shapes) != 1 or len(shapes[0]) != 1:
        found = " and ".join(map(str, shapes)) or "none"
        message = f"a kernel takes arrays of one length, (n,), at least one. Got shapes {found}."
        raise TypeError(message)
    return given, shapes[0][0]


def _file(function: Callable[..., object]) -> str:
    return inspect.getfile(function)
