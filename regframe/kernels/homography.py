"""Points through a homography, and forces on them back to its parameters.

`numbers` holds its matrix (4), translation (2), slant (2) and centre (2); see `transforms.homography`.
"""

from regframe.kernels.jit import kernel
from regframe.kernels.planar import FAR, LEAST, LOST
from regframe.types import Matrix, Points, Values


@kernel
def place(first: int, last: int, numbers: Values, points: Points, out: Points) -> None:
    """Where points first to last go, FAR where there is no image."""
    xx, xy, yx, yy, tx, ty, slant_x, slant_y, cx, cy = [numbers[k] for k in range(10)]
    for i in range(first, last):
        x, y = points[i, 0] - cx, points[i, 1] - cy
        depth = 1.0 + x * slant_x + y * slant_y
        seen = depth > LEAST and abs(x) < LOST and abs(y) < LOST
        out[i, 0] = (xx * x + xy * y) / depth + (cx + tx) if seen else FAR
        out[i, 1] = (yx * x + yy * y) / depth + (cy + ty) if seen else FAR


@kernel
def pull(first: int, last: int, numbers: Values, points: Points, forces: Points, partial: Matrix) -> None:
    """Forces times slopes, summed by block into (blocks, 8): by matrix, translation and slant."""
    xx, xy, yx, yy, _, _, slant_x, slant_y, cx, cy = [numbers[k] for k in range(10)]
    blocks, count = len(partial), len(points)
    for block in range(first, last):
        fxx = fxy = fyx = fyy = fx = fy = px = py = 0.0
        for i in range(count * block // blocks, count * (block + 1) // blocks):
            x, y = points[i, 0] - cx, points[i, 1] - cy
            depth = 1.0 + x * slant_x + y * slant_y
            if not (depth > LEAST and abs(x) < LOST and abs(y) < LOST):
                continue
            nearer = 1.0 / depth
            right, down = forces[i, 0] * nearer, forces[i, 1] * nearer
            along = ((xx * x + xy * y) * right + (yx * x + yy * y) * down) * nearer
            fxx, fxy, fyx, fyy = fxx + right * x, fxy + right * y, fyx + down * x, fyy + down * y
            fx, fy, px, py = fx + forces[i, 0], fy + forces[i, 1], px - along * x, py - along * y
        for k, total in enumerate((fxx, fxy, fyx, fyy, fx, fy, px, py)):
            partial[block, k] += total
