"""Points through a lens, a homography and another lens, and forces on them back to parameters.

`numbers` holds, in this order: of the fixed lens its centre (2), radius, k1, k2 and limit; of the homography
its matrix (4), translation (2), slant (2) and centre (2); of the moving lens the same six as of the fixed
one. A limit is the square of the seen radius up to which a lens's law rises, in radii squared.
"""

import numpy as np

from regframe.kernels.jit import kernel
from regframe.types import Matrix, Points, Values

FAR = 1e12  # where points without an image are put
LOST = 1e9  # points beyond this were put there by an earlier map
LEAST = 1e-6  # depth below which a point is on or beyond the horizon
ROUNDS = 60  # most rounds of Newton's method: bisection alone would reach the last bit in these


@kernel
def seen_radius(ideal: float, k1: float, k2: float, limit: float) -> float:
    """Where a lens shows an ideal radius, in radii, or -1 where it shows it nowhere."""
    if k2 == 0.0 or limit == np.inf:
        bend = 1.0 - 4.0 * k1 * ideal * ideal
        return 2.0 * ideal / (1.0 + np.sqrt(bend)) if bend > 1e-9 else -1.0
    high = np.sqrt(limit)
    if ideal * (1.0 + limit * (k1 + k2 * limit)) >= high:
        return -1.0
    low, at = 0.0, min(ideal, high)
    for _ in range(ROUNDS):
        square = at * at
        miss = at - ideal * (1.0 + square * (k1 + square * k2))
        if miss > 0.0:
            high = at
        else:
            low = at
        slope = 1.0 - 2.0 * ideal * at * (k1 + 2.0 * k2 * square)
        aimed = at - miss / slope if slope > 0.0 else low - 1.0
        if not low <= aimed <= high:
            aimed = 0.5 * (low + high)
        far = abs(aimed - at)
        at = aimed
        if far <= 1e-15 * (1.0 + at):
            break
    return at


@kernel
def place(first: int, last: int, numbers: Values, points: Points, out: Points) -> None:
    """Moving points of fixed points first to last, FAR where there is no image."""
    for i in range(first, last):
        out[i, 0] = FAR
        out[i, 1] = FAR
        x, y = points[i, 0] - numbers[0], points[i, 1] - numbers[1]
        square = (x * x + y * y) / (numbers[2] * numbers[2])
        if not (square < numbers[5] and abs(x) < LOST and abs(y) < LOST):
            continue
        division = 1.0 + square * (numbers[3] + square * numbers[4])
        x = x / division + numbers[0] - numbers[14]
        y = y / division + numbers[1] - numbers[15]
        depth = 1.0 + x * numbers[12] + y * numbers[13]
        if not depth > LEAST:
            continue
        u = (numbers[6] * x + numbers[7] * y) / depth + numbers[14] + numbers[10] - numbers[16]
        v = (numbers[8] * x + numbers[9] * y) / depth + numbers[15] + numbers[11] - numbers[17]
        ideal = np.sqrt(u * u + v * v) / numbers[18]
        seen = seen_radius(ideal, numbers[19], numbers[20], numbers[21])
        if seen < 0.0:
            continue
        division = 1.0 + seen * seen * (numbers[19] + seen * seen * numbers[20])
        out[i, 0] = u * division + numbers[16]
        out[i, 1] = v * division + numbers[17]


@kernel
def unbent(u: float, v: float, fx: float, fy: float, numbers: Values) -> tuple[float, float, float, float]:
    """A force on the bent place of an ideal point: on the ideal point, by k1, and the seen radius squared.

    The latter is negative where the lens shows nothing.
    """
    k1, k2, radius = numbers[19], numbers[20], numbers[18]
    seen = seen_radius(np.sqrt(u * u + v * v) / radius, k1, k2, numbers[21])
    if seen < 0.0:
        return 0.0, 0.0, 0.0, -1.0
    square = seen * seen
    division, rise = 1.0 + square * (k1 + square * k2), k1 + 2.0 * k2 * square
    x, y = u * division, v * division
    # The slope of undistortion is a (1 - b y y'), symmetric; this is its inverse, times the force.
    along = x * fx + y * fy
    grip = 2.0 * rise * along / (radius * radius * (1.0 - 2.0 * rise * square / division))
    gx, gy = fx * division + x * grip, fy * division + y * grip
    return gx, gy, square * (x * gx + y * gy) / (division * division), square


@kernel
def pull(first: int, last: int, numbers: Values, points: Points, forces: Points, partial: Matrix) -> None:
    """Forces times slopes, summed by block: matrix, translation, slant, fixed k1 and k2, moving k1 and k2."""
    blocks, count = len(partial), len(points)
    for block in range(first, last):
        total = partial[block]
        for i in range(count * block // blocks, count * (block + 1) // blocks):
            sx, sy = points[i, 0] - numbers[0], points[i, 1] - numbers[1]
            square = (sx * sx + sy * sy) / (numbers[2] * numbers[2])
            if not (square < numbers[5] and abs(sx) < LOST and abs(sy) < LOST):
                continue
            division = 1.0 + square * (numbers[3] + square * numbers[4])
            x = sx / division + numbers[0] - numbers[14]
            y = sy / division + numbers[1] - numbers[15]
            depth = 1.0 + x * numbers[12] + y * numbers[13]
            if not depth > LEAST:
                continue
            nearer = 1.0 / depth
            mx, my = numbers[6] * x + numbers[7] * y, numbers[8] * x + numbers[9] * y
            u = mx * nearer + numbers[14] + numbers[10] - numbers[16]
            v = my * nearer + numbers[15] + numbers[11] - numbers[17]
            fx, fy, bend, seen = unbent(u, v, forces[i, 0], forces[i, 1], numbers)
            if seen < 0.0:
                continue
            along = (mx * fx + my * fy) * nearer * nearer
            hx = (numbers[6] * fx + numbers[8] * fy) * nearer - along * numbers[12]
            hy = (numbers[7] * fx + numbers[9] * fy) * nearer - along * numbers[13]
            freed = square * (sx * hx + sy * hy) / (division * division)
            right, down = fx * nearer, fy * nearer
            total[0] += right * x
            total[1] += right * y
            total[2] += down * x
            total[3] += down * y
            total[4] += fx
            total[5] += fy
            total[6] -= along * x
            total[7] -= along * y
            total[8] -= freed
            total[9] -= square * freed
            total[10] += bend
            total[11] += seen * bend
