"""Wallace's generator, one deviate at a time, by the pointers of the original."""

import math

UNIT = 30000000.0
LAYOUTS = {0: (0, 512, 1, 508), 1: (512, 0, 1, 508), 2: (1, 0, 2, 1016), 3: (0, 1, 2, 1016)}
WALKS = {0: (-1, -1, 1, 1), 1: (-1, 1, 1, -1), 2: (1, -1, 1, -1), 3: (1, 1, -1, -1)}
JUMPS = {0: (-1, 1, -1, 1), 1: (1, -1, -1, 1), 2: (1, 1, -1, -1), 3: (-1, 1, 1, -1)}
TURNS = {0: (1, 2, 3, 0), 1: (1, 0, 2, 3), 2: (3, 1, 2, 0), 3: (2, 3, 0, 1)}


def signed(word):
    word &= 0xFFFFFFFF
    return word - 2**32 if word >= 2**31 else word


class Variates:
    def __init__(self, seed):
        self.q = self.w = signed(seed)
        self.pool = [0] * 1024
        self.n, self.left, self.gain, self.inv = 0, 1, 1.0 / UNIT, 0.0

    def word(self):
        self.q = signed(69069 * self.q + 33331)
        turn = self.w <= 0
        self.w = signed(2 * self.w)
        if turn:
            self.w = signed(self.w ^ 333556017)
        return signed(self.w + self.q)

    def draw(self):
        self.left -= 1
        if self.left > 0:
            return self.gain * self.pool[self.left]
        if self.n % 256 == 0:
            if self.n % 65536 == 0:
                self.refill()
            self.measure()
        self.n += 1
        self.left = 1023
        self.mix()
        a = 1.0 + 1.0 / 8192.0
        z = a * math.sqrt(1.0 / 2048.0) * (math.sqrt(2048.0 - a * a) / a + self.gain * self.pool[1023])
        self.gain = (1.0 / UNIT) * z * self.inv
        return self.gain * self.pool[0]

    def measure(self):
        total = 0.0
        for v in self.pool:
            total += float(v) * float(v)
        self.inv = 1.0 / math.sqrt(total / (UNIT * UNIT * 1024.0))

    def mix(self):
        t = self.word()
        t = (~t if t < 0 else t) >> 15
        skew, stride, kind = 4 * (t & 127), 8 * ((t >> 7) & 63) + 4, (t >> 13) & 3
        walk, jump, step, mask = LAYOUTS[self.n % 4]
        if step == 2:
            skew, stride = 2 * skew, 2 * stride
        at = [walk + k * 128 * step for k in range(4)]
        move = [step] * 4
        at[kind] += 127 * step
        move[kind] = -step
        for _ in range(128):
            skew = (skew + stride) & mask
            group = [jump + skew + k * step for k in range(4)]
            x = [s * self.pool[i] for s, i in zip(WALKS[kind], at, strict=True)]
            y = [s * self.pool[i] for s, i in zip(JUMPS[kind], group, strict=True)]
            for i, value in zip(group, x, strict=True):
                self.pool[i] = (sum(x) >> 1) - value
            for i, j in zip(at, TURNS[kind], strict=True):
                self.pool[i] = (sum(y) >> 1) - y[j]
            at = [i + m for i, m in zip(at, move, strict=True)]

    def refill(self):
        filled, total = 0, 0.0
        while filled < 1024:
            x, y = self.word() * 2.0**-31, self.word() * 2.0**-31
            r = x * x + y * y
            if r > 1.0 or r < 0.1:
                continue
            t = self.word()
            e = -2.0 * math.log(((~t if t < 0 else t) + 0.5) * 2.0**-31)
            total += e
            phi = math.sqrt(e / r)
            self.pool[filled : filled + 2] = [int(UNIT * x * phi), int(UNIT * y * phi)]
            filled += 2
        k = math.sqrt(1024.0 / total)
        self.pool = [int(v * k + (0.5 if v > 0 else -0.5)) for v in self.pool]
