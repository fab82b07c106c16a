"""Wallace's generator of normal deviates, bit for bit the one that ITK uses.

C. S. Wallace, "Fast pseudorandom generators for normal and exponential variates", ACM TOMS 22(1), 1996:
a pool of normal deviates, kept as integers, is mixed by orthogonal matrices with entries +-1/2. The
groups that one pass mixes share no place, so numpy does a whole pass at once and nothing is compiled.
"""

import math
from typing import final

import numpy as np
from numpy.typing import NDArray

from regframe.types import Values

Places = NDArray[np.int64]

POOL = 1024
GROUP = 128
UNIT = 30000000.0
WORD = 2**32

# The pool's sum of squares never changes, a true sample's does: each pass scales its output by a deviate
# that makes the block's sum of squares nearly chi-square.
_SPREAD = 1.0 + 1.0 / (8.0 * POOL)
_SHIFT = math.sqrt(2.0 * POOL - _SPREAD * _SPREAD) / _SPREAD
_SLOPE = _SPREAD * math.sqrt(1.0 / (2.0 * POOL))

_LAYOUTS = ((0, 512, 1), (512, 0, 1), (1, 0, 2), (0, 1, 2))  # first walked place, first jumped place, step
_WALK_SIGNS = np.array([[-1, -1, 1, 1], [-1, 1, 1, -1], [1, -1, 1, -1], [1, 1, -1, -1]])[:, :, None]
_JUMP_SIGNS = np.array([[-1, 1, -1, 1], [1, -1, -1, 1], [1, 1, -1, -1], [-1, 1, 1, -1]])[:, :, None]
_TURNS = ((1, 2, 3, 0), (1, 0, 2, 3), (3, 1, 2, 0), (2, 3, 0, 1))
_OUTPUT = np.array([0, *range(POOL - 2, 0, -1)])
_REMEASURE = 256
_REFILL = 65536


@final
class Wallace:
    """A stream of standard normal deviates; has numpy's method name, so either can serve an optimizer.

    Every seed is fixed, 0 too: SimpleITK takes the wall clock for seed 0, which nobody can repeat.

    Parameters
    ----------
    seed : int
        Taken modulo 2**32, so -1 and 4294967295 are the same seed.

    Examples
    --------
    >>> Wallace(42).standard_normal(2)
    array([ 0.27288016, -0.88183393])
    """

    def __init__(self, seed: int) -> None:
        self._congruential = self._register = seed % WORD
        self._pool = np.zeros(POOL, dtype=np.int64)
        self._passes = 0
        self._gain = 1.0 / UNIT
        self._inverse = 0.0
        self._ready = np.empty(0)

    def standard_normal(self, size: int) -> Values:
        """Return the next deviates.

        Parameters
        ----------
        size : int

        Returns
        -------
        (size,) float64
        """
        blocks, total = [self._ready], len(self._ready)
        while total < size:
            block = self._block()
            blocks.append(block)
            total += len(block)
        stream = np.concatenate(blocks)
        self._ready = stream[size:]
        return stream[:size].copy()

    def _word(self) -> int:
        """A random word, signed."""
        self._congruential = (69069 * self._congruential + 33331) % WORD
        turn = self._register == 0 or self._register >= WORD // 2
        self._register = (2 * self._register) % WORD ^ (333556017 if turn else 0)
        word = (self._register + self._congruential) % WORD
        return word - WORD if word >= WORD // 2 else word

    def _half_word(self) -> int:
        """A random word of 31 bits."""
        word = self._word()
        return ~word if word < 0 else word

    def _block(self) -> Values:
        """Run a pass: the next 1023 deviates."""
        if self._passes % _REMEASURE == 0:
            if self._passes % _REFILL == 0:
                self._refill()
            # cumsum rather than sum, which adds pairwise and differs in the last bit
            squares = np.cumsum(self._pool.astype(np.float64) ** 2)[-1]
            self._inverse = 1.0 / math.sqrt(squares / (UNIT * UNIT * POOL))
        self._passes += 1
        self._mix()
        spread = _SLOPE * (_SHIFT + self._gain * float(self._pool[-1]))
        self._gain = (1.0 / UNIT) * spread * self._inverse
        return np.asarray(self._gain * self._pool[_OUTPUT], dtype=np.float64)

    def _mix(self) -> None:
        """Multiply 256 groups of four by orthogonal matrices, one half of the pool into the other."""
        bits = self._half_word() >> 15
        skew, stride, kind = 4 * (bits & 127), 8 * (bits >> 7 & 63) + 4, bits >> 13 & 3
        walk_base, jump_base, step = _LAYOUTS[self._passes % 4]
        walk = walk_base + step * np.arange(4 * GROUP).reshape(4, GROUP)
        walk[kind] = walk[kind, ::-1]
        jumps = step * (skew + stride * np.arange(1, GROUP + 1)) & step * 508
        jump = jump_base + jumps + step * np.arange(4)[:, None]

        pool = self._pool
        walked, jumped = _WALK_SIGNS[kind] * pool[walk], _JUMP_SIGNS[kind] * pool[jump]
        pool[jump] = (walked.sum(axis=0) >> 1) - walked
        pool[walk] = ((jumped.sum(axis=0) >> 1) - jumped)[list(_TURNS[kind])]

    def _refill(self) -> None:
        """Fill the pool by the polar method of Box and Muller."""
        fresh: list[int] = []
        energy = 0.0
        while len(fresh) < POOL:
            x, y = self._word() * 2.0**-31, self._word() * 2.0**-31
            radius = x * x + y * y
            if not 0.1 <= radius <= 1.0:
                continue
            drawn = -2.0 * math.log((self._half_word() + 0.5) * 2.0**-31)
            energy += drawn
            factor = math.sqrt(drawn / radius)
            fresh += [int(UNIT * x * factor), int(UNIT * y * factor)]
        scaled = np.array(fresh) * math.sqrt(POOL / energy)
        self._pool = np.trunc(scaled + np.copysign(0.5, scaled)).astype(np.int64)
