"""A street on a clear evening, as a visual and a thermal camera would see it.

What both cameras share is outlines. Everything else is free: paint, shadows and writing are seen by
one, warm air, heat bridges and engines by the other, and brighter in one may be darker in the other.
World units are those of `painting`; temperatures are apparent, degrees Celsius.
"""

import numpy as np
from scipy import ndimage

from regframe.testing.painting import Canvas, Look, Patch, Spot
from regframe.types import Volume

HORIZON = 0.56
KERB = 0.765
GLASS = Look(0.16, 7.0, 0.01, 0.4)
RUBBER = Look(0.08, 33.0, 0.01, 0.2)
METAL = Look(0.27, 17.5, 0.01, 0.2)


def paint_street(canvas: Canvas) -> None:
    """Paint the whole scene, from far to near."""
    _sky(canvas)
    _hills(canvas)
    left, right = canvas.span
    _ground(canvas)
    _facades(canvas, left, right)
    rng = canvas.rng
    for place in (0.30, 0.93, 1.36):
        _tree(canvas, (place + rng.uniform(-0.04, 0.04), 0.70), rng.uniform(0.42, 0.52))
    for place in (0.02, 0.66, 1.52):
        _lamp(canvas, (place + rng.uniform(-0.02, 0.02), 0.745), rng.uniform(0.50, 0.58))
    _wires(canvas, left, right)
    _fence(canvas, 0.70, 0.93)
    _person(canvas, (0.44 + rng.uniform(-0.02, 0.02), 0.77), 0.185)
    _person(canvas, (0.50 + rng.uniform(-0.01, 0.02), 0.765), 0.165)
    _car(canvas, (0.14, 0.83), 0.36, running=True)
    _car(canvas, (1.00, 0.845), 0.38, running=False)
    _bicycle(canvas, (0.80, 0.755), 0.045)
    _person(canvas, (0.73 + rng.uniform(-0.02, 0.02), 0.93), 0.27)
    _cat(canvas, (0.36, 0.91))


def _sky(canvas: Canvas) -> None:
    whole, height = canvas.everywhere(), canvas.heights()
    low = np.clip(height / HORIZON, -0.5, 1.0)
    canvas.light[:] = 0.70 + 0.16 * low
    canvas.heat[:] = -12.0 + 11.0 * low**2
    cloud = _clouds(canvas, whole)
    canvas.light += 0.09 * np.clip(cloud, -0.8, 2.0)
    canvas.heat += 0.8 * _clouds(canvas, whole) + 1.8 * np.clip(cloud, 0.0, 2.0)


def _clouds(canvas: Canvas, whole: Patch) -> Volume:
    ny, nx = canvas.shape
    coarse = Patch(whole.rows, whole.columns, whole.cover[: ny // 4 + 2, : nx // 4 + 2])
    return np.asarray(ndimage.zoom(canvas.texture(coarse, canvas.clouds), 4, order=1)[:ny, :nx])


def _hills(canvas: Canvas) -> None:
    left, right = canvas.span
    places = np.linspace(left, right, 24)
    for base, swell, look in (
        (0.36, 0.045, Look(0.55, 9.0, 0.02, 0.5)),
        (0.44, 0.03, Look(0.40, 12.0, 0.05, 1.0)),
    ):
        phase = canvas.rng.uniform(0, 6.28, 3)
        ridge = base - swell * sum(
            np.sin(rate * places + turn) for rate, turn in zip((2.1, 4.7, 9.9), phase, strict=True)
        )
        line = list(zip(places, ridge, strict=True))
        canvas.paint(canvas.polygon([*line, (right, 0.7), (left, 0.7)]), look)


def _ground(canvas: Canvas) -> None:
    left, right = canvas.span
    bottom = canvas.heights()[-1, 0] + 1.0
    canvas.paint(canvas.box(left - 1, HORIZON + 0.08, right + 1, 0.73), Look(0.34, 12.5, 0.07, 0.9))
    canvas.paint(canvas.box(left - 1, 0.715, right + 1, KERB), Look(0.62, 19.0, 0.02, 0.3))
    canvas.paint(canvas.box(left - 1, KERB, right + 1, bottom), Look(0.36, 24.0, 0.03, 0.5))
    canvas.paint(canvas.box(left - 1, KERB, right + 1, KERB + 0.012), Look(0.74, 21.0, 0.02, 0.2))
    for slab in np.arange(left, right, 0.11):
        canvas.shade(canvas.stroke([(slab, 0.715), (slab + 0.02 * (slab - 0.67), KERB)], 0.003), 0.7)
    for dash in np.arange(left, right, 0.26):
        corners = [(dash, 0.905), (dash + 0.13, 0.905), (dash + 0.138, 0.922), (dash + 0.004, 0.922)]
        canvas.paint(canvas.polygon(corners), Look(0.83, 22.8, 0.04, 0.3))
    for track in (0.86, 0.885, 0.965, 1.0):
        canvas.warm(canvas.glow(((left + right) / 2, track), (right - left) * 0.6, 0.012), 2.2)
    _crossing(canvas, 0.52)
    # The low sun left warm asphalt where no shadow fell an hour ago; the shadows have moved since.
    for _ in range(5):
        spot = (canvas.rng.uniform(left, right), canvas.rng.uniform(0.8, 1.05))
        canvas.warm(canvas.glow(spot, canvas.rng.uniform(0.1, 0.25), 0.04), canvas.rng.uniform(-2.5, 3.0))
    for _ in range(9):
        spot = (canvas.rng.uniform(left, right), canvas.rng.uniform(0.8, 1.05))
        canvas.shade(canvas.disc(spot, canvas.rng.uniform(0.01, 0.05), 0.008), canvas.rng.uniform(0.6, 0.9))


def _crossing(canvas: Canvas, middle: float) -> None:
    for stripe in np.arange(-0.11, 0.12, 0.05):
        top, low = middle + stripe, middle + 1.9 * stripe
        canvas.paint(
            canvas.polygon([(top, 0.79), (top + 0.026, 0.79), (low + 0.045, 1.05), (low, 1.05)]),
            Look(0.86, 23.2, 0.05, 0.4),
        )


def _facades(canvas: Canvas, left: float, right: float) -> None:
    rng = canvas.rng
    # Light and heat of the walls are drawn apart, so that no rule ties one to the other.
    looks = [(0.66, 15.5), (0.33, 19.0), (0.50, 13.5), (0.80, 17.0), (0.42, 15.0), (0.58, 21.0)]
    order = rng.permutation(len(looks))
    edge, number = left - 0.05, 0
    while edge < right:
        width, top = rng.uniform(0.24, 0.40), rng.uniform(0.12, 0.34)
        light, heat = looks[order[number % len(looks)]]
        if number % 3 != 2 or top > 0.3:
            _facade(canvas, (edge, top, edge + width, 0.70), Look(light, heat, 0.018, 0.25), number)
        edge += width + (0.0 if rng.random() < 0.55 else rng.uniform(0.03, 0.10))
        number += 1


def _facade(canvas: Canvas, frame: tuple[float, float, float, float], wall: Look, number: int) -> None:
    left, top, right, bottom = frame
    rng = canvas.rng
    light = wall.light or 0.5
    house = canvas.box(left, top, right, bottom)
    canvas.paint(house, wall)
    shading = np.linspace(1.06, 0.9, house.cover.shape[0])[:, None]
    canvas.light[house.rows, house.columns] *= 1.0 + house.cover * (shading - 1.0)
    canvas.warm(canvas.glow(((left + right) / 2, bottom), (right - left) / 2, 0.2), rng.uniform(-1.5, 2.0))
    _roof(canvas, frame, number)
    if number % 3 == 0:
        for line in np.arange(top + 0.012, bottom, 0.014):
            canvas.shade(canvas.box(left, line, right, line + 0.003), 0.82)
    elif number % 3 == 1:
        _mural(canvas, (left, 0.525, right, 0.582), light)
    floors = np.arange(0.435 if number % 3 == 1 else 0.49, top + 0.02, -0.115)
    for floor in floors:
        # Slab edges leak heat through the wall, invisible to the eye.
        canvas.warm(canvas.box(left, floor + 0.098, right, floor + 0.108), rng.uniform(0.8, 2.2))
        _windows(canvas, (left, floor, right), light)
    door = rng.uniform(left + 0.05, right - 0.1)
    canvas.paint(canvas.box(door - 0.006, 0.585, door + 0.066, bottom), Look(light * 0.6, None))
    canvas.paint(
        canvas.box(door, 0.592, door + 0.06, bottom), Look(rng.uniform(0.1, 0.6), rng.uniform(18, 23))
    )
    canvas.warm(canvas.glow((door + 0.03, 0.592), 0.035, 0.012), 4.0)
    if number % 2:
        _vent(canvas, (rng.uniform(left + 0.04, right - 0.04), rng.uniform(0.60, 0.64)))
    canvas.shade(canvas.box(left, bottom - 0.012, right, bottom), 0.6)


def _roof(canvas: Canvas, frame: tuple[float, float, float, float], number: int) -> None:
    left, top, right, _ = frame
    rng = canvas.rng
    if number % 2:
        ridge = top - rng.uniform(0.05, 0.09)
        chimney = left + (right - left) * rng.uniform(0.2, 0.35)
        canvas.paint(canvas.box(chimney, ridge - 0.03, chimney + 0.035, top), Look(0.35, 29.0, 0.03, 0.4))
        canvas.warm(canvas.glow((chimney + 0.018, ridge - 0.045), 0.02, 0.025), 9.0)
        tiles = [
            (left - 0.012, top + 0.006),
            (left + 0.07, ridge),
            (right - 0.07, ridge),
            (right + 0.012, top + 0.006),
        ]
        canvas.paint(canvas.polygon(tiles), Look(rng.uniform(0.22, 0.45), rng.uniform(1.0, 7.0), 0.05, 0.5))
    else:
        canvas.paint(
            canvas.box(left - 0.008, top - 0.014, right + 0.008, top + 0.008), Look(0.70, 9.0, 0.02, 0.3)
        )


def _windows(canvas: Canvas, frame: tuple[float, float, float], wall: float) -> None:
    left, floor, right = frame
    rng = canvas.rng
    count = int((right - left) // 0.085)
    pitch = (right - left) / count
    for place in left + pitch * (np.arange(count) + 0.5):
        sides = (place - 0.024, floor, place + 0.024, floor + 0.078)
        rim = 0.92 if wall < 0.6 else 0.25
        canvas.paint(
            canvas.box(sides[0] - 0.006, floor - 0.006, sides[2] + 0.006, sides[3] + 0.006), Look(rim, 16.0)
        )
        kind = rng.random()
        lit = Look(0.88, 15.0, 0.03, 0.4) if kind < 0.22 else GLASS
        glass = lit if kind < 0.85 else Look(GLASS.light, 21.5, 0.02, 0.3)
        canvas.paint(canvas.box(*sides), glass)
        if rng.random() < 0.4:
            fall = floor + 0.078 * rng.uniform(0.3, 0.8)
            canvas.paint(
                canvas.box(sides[0], floor, sides[2], fall), Look(rng.uniform(0.45, 0.8), None, 0.04)
            )
        canvas.paint(canvas.box(place - 0.002, floor, place + 0.002, sides[3]), Look(rim, 15.0))
        canvas.paint(canvas.box(sides[0], floor + 0.036, sides[2], floor + 0.040), Look(rim, 15.0))
        if rng.random() < 0.5:
            canvas.warm(canvas.glow((place, sides[3] + 0.010), 0.03, 0.010), rng.uniform(1.5, 4.5))


def _mural(canvas: Canvas, frame: tuple[float, float, float, float], wall: float) -> None:
    left, top, right, bottom = frame
    rng = canvas.rng
    board = canvas.box(left + 0.015, top, right - 0.015, bottom)
    canvas.paint(board, Look(0.95 if wall < 0.6 else 0.12, None, 0.01))
    ink = 0.15 if wall < 0.6 else 0.9
    place = left + 0.03
    while place < right - 0.045:
        width = rng.uniform(0.010, 0.024)
        low, high, end = bottom - 0.014, top + 0.014, place + width
        paths: list[list[Spot]] = [
            [(place, low), (place, high), (end, high), (end, low)],
            [(place, high), (end, high), (place, low), (end, low)],
            [(place, high), (place, low), (end, low)],
            [(place, low), ((place + end) / 2, high), (end, low)],
            [(place, low), (place, high), (end, high), (end, low), (place, low)],
        ]
        canvas.paint(canvas.stroke(paths[rng.integers(5)], 0.006), Look(ink, None, 0.0))
        place += width + 0.014


def _vent(canvas: Canvas, centre: Spot) -> None:
    x, y = centre
    canvas.paint(canvas.box(x - 0.014, y - 0.010, x + 0.014, y + 0.010), Look(0.5, 34.0, 0.02, 0.3))
    canvas.warm(canvas.glow((x, y - 0.03), 0.02, 0.04), 5.0)


def _tree(canvas: Canvas, foot: Spot, height: float) -> None:
    rng = canvas.rng
    x, y = foot
    crown = (x, y - 0.66 * height)
    canvas.shade(canvas.disc((x + 0.13, y + 0.035), 0.17, 0.022), 0.55)
    canvas.warm(canvas.glow((x - 0.02, y + 0.02), 0.12, 0.02), -1.0)
    for bough in (-0.5, -0.2, 0.15, 0.45):
        tip = (x + bough * 0.34 * height, y - rng.uniform(0.65, 0.95) * height)
        canvas.paint(canvas.stroke([(x, y - 0.3 * height), tip], 0.010), Look(0.20, 15.5, 0.03, 0.3))
    canvas.paint(canvas.stroke([(x - 0.004, y), (x, y - 0.6 * height)], 0.026), Look(0.24, 16.5, 0.04, 0.4))
    for _ in range(130):
        turn, reach = rng.uniform(0, 2 * np.pi), np.sqrt(rng.random())
        spot = (
            crown[0] + 0.33 * height * reach * np.cos(turn),
            crown[1] + 0.36 * height * reach * np.sin(turn),
        )
        # Leaves above and to the left catch the sky; in heat they are all close to the air.
        sun = 0.30 - 0.09 * (spot[0] - crown[0]) / height - 0.25 * (spot[1] - crown[1]) / height
        leaf = Look(sun + rng.normal(0, 0.05), 11.0 + rng.normal(0, 0.8), 0.07, 0.8)
        canvas.paint(canvas.bush(spot, rng.uniform(0.010, 0.034), rng.uniform(0.009, 0.024)), leaf)


def _lamp(canvas: Canvas, foot: Spot, height: float) -> None:
    x, y = foot
    post = [(x, y), (x, y - height), (x + 0.02, y - height - 0.02), (x + 0.09, y - height - 0.024)]
    canvas.shade(canvas.polygon([(x, y), (x + 0.01, y), (x + 0.24, 0.83), (x + 0.225, 0.83)]), 0.62)
    canvas.paint(canvas.stroke(post, 0.011), Look(0.22, 18.5, 0.01, 0.2))
    canvas.paint(canvas.stroke([(x, y), (x, y - 0.06)], 0.02), METAL)
    canvas.paint(canvas.disc((x + 0.10, y - height - 0.02), 0.024, 0.009), Look(0.93, 41.0, 0.0, 0.2))


def _wires(canvas: Canvas, left: float, right: float) -> None:
    along = np.linspace(0.0, 1.0, 25)
    for start, sag, end in ((0.06, 0.07, 0.13), (0.085, 0.075, 0.15), (0.20, 0.05, 0.10)):
        drop = start + (end - start) * along + 4 * sag * along * (1 - along)
        line = list(zip(left + (right - left) * along, drop, strict=True))
        canvas.paint(canvas.stroke(line, 0.0028), Look(0.12, 11.0, 0.0, 0.0))


def _fence(canvas: Canvas, left: float, right: float) -> None:
    for post in np.arange(left, right, 0.022):
        canvas.paint(canvas.box(post, 0.655, post + 0.008, 0.722), Look(0.85, 15.8, 0.02, 0.3))
    for rail in (0.668, 0.702):
        canvas.paint(canvas.box(left - 0.01, rail, right, rail + 0.007), Look(0.85, 15.8, 0.02, 0.3))


def _person(canvas: Canvas, foot: Spot, height: float) -> None:
    rng = canvas.rng
    x, y = foot
    cloth = rng.uniform(0.12, 0.9, size=2)
    stride = rng.uniform(0.06, 0.12) * height
    canvas.shade(canvas.polygon([(x - stride, y), (x + stride, y), (x + 0.9 * height, y + 0.045)]), 0.6)

    def limb(path: list[Spot], width: float, look: Look) -> None:
        canvas.paint(canvas.stroke([(x + a * height, y - b * height) for a, b in path], width * height), look)

    legs, shirt = Look(cloth[0], 26.5, 0.02, 0.5), Look(cloth[1], 25.0, 0.03, 0.6)
    skin, step = Look(0.62, 33.0, 0.02, 0.2), stride / height
    limb([(-step, 0.0), (-0.02, 0.25), (0.0, 0.46)], 0.085, legs)
    limb([(step, 0.0), (0.05, 0.25), (0.0, 0.46)], 0.085, legs)
    for toe in (-step, step):
        limb([(toe, 0.01), (toe + 0.05, 0.01)], 0.05, Look(0.1, 20.0))
    limb([(0.0, 0.50), (0.0, 0.74)], 0.17, shirt)
    limb([(-0.09, 0.76), (0.09, 0.76)], 0.10, shirt)
    limb([(-0.10, 0.76), (-0.14, 0.60), (-0.09, 0.47)], 0.06, shirt)
    limb([(0.10, 0.76), (0.15, 0.62), (0.10, 0.50)], 0.06, shirt)
    limb([(-0.09, 0.46), (-0.085, 0.44)], 0.05, skin)
    limb([(0.10, 0.49), (0.105, 0.47)], 0.05, skin)
    limb([(0.0, 0.80), (0.0, 0.86)], 0.06, skin)
    canvas.paint(canvas.disc((x, y - 0.915 * height), 0.058 * height, 0.072 * height), skin)
    hair = canvas.disc((x - 0.004 * height, y - 0.945 * height), 0.058 * height, 0.048 * height)
    canvas.paint(hair, Look(rng.uniform(0.05, 0.4), 28.5))


def _car(canvas: Canvas, foot: Spot, length: float, *, running: bool) -> None:
    x, y = foot
    rng = canvas.rng

    def at(path: list[Spot]) -> list[Spot]:
        return [(x + a * length, y - b * length) for a, b in path]

    # The body mirrors the cold sky; only what is warmed from inside stands out.
    body = Look(rng.choice([0.12, 0.78, 0.5]), 14.5, 0.008, 0.2)
    canvas.shade(canvas.disc((x + 0.54 * length, y + 0.006), 0.56 * length, 0.016), 0.35)
    under = canvas.disc((x + 0.5 * length, y + 0.004), 0.5 * length, 0.012)
    canvas.warm(under, 5.0 if running else -1.5)
    shell = at([(0.01, 0.07), (0.0, 0.17), (0.05, 0.21), (0.22, 0.235), (0.34, 0.34), (0.62, 0.345),
                (0.78, 0.245), (0.96, 0.215), (1.0, 0.16), (0.99, 0.07)])  # fmt: skip
    canvas.paint(canvas.polygon(shell), body)
    canvas.shade(canvas.polygon(at([(0.01, 0.13), (0.99, 0.13), (0.99, 0.07), (0.01, 0.07)])), 0.75)
    canvas.warm(canvas.polygon(at([(0.22, 0.235), (0.34, 0.34), (0.62, 0.345), (0.78, 0.245)])), -4.0)
    for pane in (
        [(0.27, 0.24), (0.36, 0.325), (0.475, 0.33), (0.475, 0.24)],
        [(0.495, 0.24), (0.495, 0.33), (0.61, 0.33), (0.72, 0.24)],
    ):
        canvas.paint(canvas.polygon(at(pane)), Look(0.2, 4.0, 0.02, 0.3))
    canvas.shade(canvas.stroke(at([(0.485, 0.08), (0.485, 0.24)]), 0.003), 0.5)
    canvas.paint(canvas.disc(at([(0.985, 0.185)])[0], 0.02 * length), Look(0.95, 18.0, 0.0, 0.2))
    canvas.paint(canvas.disc(at([(0.015, 0.185)])[0], 0.016 * length), Look(0.3, 16.0, 0.0, 0.2))
    if running:
        canvas.warm(canvas.glow(at([(0.87, 0.17)])[0], 0.17 * length, 0.09 * length), 17.0)
        canvas.warm(canvas.glow(at([(-0.03, 0.05)])[0], 0.05 * length, 0.03 * length), 14.0)
    for hub in (0.20, 0.80):
        _wheel(canvas, at([(hub, 0.075)])[0], 0.078 * length, 33.0 if running else 15.5)


def _wheel(canvas: Canvas, hub: Spot, radius: float, heat: float) -> None:
    canvas.paint(canvas.disc(hub, radius), Look(RUBBER.light, heat, 0.01, 0.2))
    canvas.paint(canvas.disc(hub, 0.58 * radius), Look(0.68, heat - 4.0, 0.02, 0.2))
    canvas.paint(canvas.disc(hub, 0.2 * radius), Look(0.3, heat - 2.0, 0.0, 0.2))


def _bicycle(canvas: Canvas, hub: Spot, radius: float) -> None:
    x, y = hub[0], hub[1] - radius
    look = Look(0.1, 20.5, 0.0, 0.2)
    turns = np.linspace(0, 2 * np.pi, 25)
    for wheel in (x, x + 2.4 * radius):
        rim = [(wheel + radius * np.cos(turn), y + radius * np.sin(turn)) for turn in turns]
        canvas.paint(canvas.stroke(rim, 0.005), look)
    seat, bars, pedal = (
        (x + 0.7 * radius, y - 1.1 * radius),
        (x + 2.1 * radius, y - 1.2 * radius),
        (x + radius, y),
    )
    for path in ([(x, y), seat, pedal, (x, y)], [seat, bars, pedal], [bars, (x + 2.4 * radius, y)]):
        canvas.paint(canvas.stroke(path, 0.005), Look(0.75, 17.0, 0.0, 0.1))


def _cat(canvas: Canvas, foot: Spot) -> None:
    x, y = foot
    fur = Look(0.30, 29.0, 0.03, 0.5)
    canvas.paint(canvas.disc((x, y - 0.022), 0.030, 0.014), fur)
    canvas.paint(canvas.disc((x + 0.032, y - 0.036), 0.012), Look(0.30, 31.5, 0.02, 0.2))
    canvas.paint(canvas.stroke([(x - 0.028, y - 0.026), (x - 0.05, y - 0.05)], 0.006), Look(0.30, 24.0))
    for leg in (-0.02, -0.008, 0.012, 0.022):
        canvas.paint(canvas.stroke([(x + leg, y - 0.02), (x + leg, y)], 0.006), fur)
