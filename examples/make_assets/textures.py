"""Draws the examples' textures from nothing but arithmetic: the same pixels on every machine.

An image is an array (height, width, 3) of floats from 0 to 1, first row at the top; those that tile
do so in both directions. Relief is painted in, lit from the upper left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Field: TypeAlias = npt.NDArray[np.float64]
"""One value per pixel (height, width), or a picture (height, width, 3)."""
Ramp: TypeAlias = Sequence[tuple[float, tuple[int, int, int]]]
"""Colours at rising values, as red, green and blue from 0 to 255."""


def scatter(rows: npt.ArrayLike, columns: npt.ArrayLike, seed: int) -> Field:
    """A random number from 0 to 1 for each pair of whole numbers: a hash, so that no generator's version matters."""
    mixed = np.asarray(rows, np.int64) * 0x9E3779 + np.asarray(columns, np.int64) * 0x85EBCA + seed * 0xC2B2AE3D
    mixed &= 0xFFFFFFFF
    for shift, factor in ((16, 0x7FEB352D), (15, 0x46CA68B1)):  # below 2**31, so that no product overflows
        mixed = ((mixed ^ (mixed >> shift)) * factor) & 0xFFFFFFFF
    return (mixed ^ (mixed >> 16)).astype(np.float64) / 2**32


def noise(shape: tuple[int, int], cells: tuple[int, int], seed: int) -> Field:
    """Perlin's gradient noise, about -1 to 1, that tiles; ``cells`` bumps down and across."""
    y = np.arange(shape[0])[:, None] * cells[0] / shape[0]
    x = np.arange(shape[1])[None, :] * cells[1] / shape[1]
    row, column = y.astype(int), x.astype(int)
    fy, fx = y - row, x - column

    def corner(dy: int, dx: int) -> Field:
        angle = scatter((row + dy) % cells[0], (column + dx) % cells[1], seed) * 2 * np.pi
        slope: Field = np.cos(angle) * (fx - dx) + np.sin(angle) * (fy - dy)
        return slope

    sy, sx = (f * f * f * (f * (f * 6 - 15) + 10) for f in (fy, fx))
    top = corner(0, 0) * (1 - sx) + corner(0, 1) * sx
    bottom = corner(1, 0) * (1 - sx) + corner(1, 1) * sx
    value: Field = 1.5 * (top * (1 - sy) + bottom * sy)
    return value


def fractal(shape: tuple[int, int], cells: tuple[int, int], seed: int, octaves: int = 4) -> Field:
    """Noise with finer noise on it, each of half the size and strength: about -1 to 1."""
    total = np.zeros(shape)
    for k in range(octaves):
        total += noise(shape, (cells[0] << k, cells[1] << k), seed + k) / 2**k
    return total / 1.5


def grain(shape: tuple[int, int], seed: int) -> Field:
    """Unrelated pixels from -1 to 1."""
    return scatter(np.arange(shape[0])[:, None], np.arange(shape[1])[None, :], seed) * 2 - 1


def smoothstep(low: float, high: float, value: Field) -> Field:
    """0 below ``low``, 1 above ``high``, smooth between."""
    t = np.clip((value - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def coloured(value: Field, ramp: Ramp) -> Field:
    """The colour of each value on a ramp."""
    at = [stop for stop, _ in ramp]
    channels = [np.interp(value, at, [colour[k] / 255 for _, colour in ramp]) for k in range(3)]
    return np.stack(channels, axis=-1)


def lit(picture: Field, height: Field, strength: float) -> Field:
    """The picture with slopes that face the upper left brighter, the others darker."""
    slope = 2 * height - np.roll(height, 1, axis=0) - np.roll(height, 1, axis=1)
    return picture * np.clip(1 + strength * slope, 0.35, 1.6)[..., None]


def wood(shape: tuple[int, int], seed: int) -> tuple[Field, Field]:
    """Wood whose fibres run down the picture: its colours, and a height that follows the fibres."""
    bend = fractal(shape, (1, 3), seed, 2)
    rings = np.sin(2 * np.pi * (np.arange(shape[1])[None, :] * 5 / shape[1] + 1.6 * bend))
    fibres = noise(shape, (2, shape[1] // 3), seed + 10) + 0.6 * noise(shape, (6, shape[1] // 2), seed + 11)
    value = 0.5 + 0.2 * rings + 0.22 * fibres + 0.1 * bend
    ramp = ((0.0, (98, 64, 36)), (0.35, (142, 99, 59)), (0.65, (174, 128, 81)), (1.0, (204, 160, 110)))
    return coloured(value, ramp), fibres


def board(shape: tuple[int, int], seed: int) -> Field:
    """One board seen from its broad side, fibres down the picture, with rounded edges."""
    tone = 0.86 + 0.26 * float(scatter(seed, 7, 3))
    picture, fibres = wood(shape, seed * 31)
    y, x = np.arange(shape[0])[:, None], np.arange(shape[1])[None, :]
    edge = np.minimum(np.minimum(x + 0.5, shape[1] - 0.5 - x), np.minimum(y + 0.5, shape[0] - 0.5 - y))
    picture = lit(picture, fibres, 0.1) * tone
    bright = smoothstep(0, 5, edge) * 0.45 + 0.55
    # The upper and left edges catch the light.
    bright = np.where((np.minimum(x, y) < 4) & (edge > 1) & (edge < 4), bright * 1.25, bright)
    return picture * bright[..., None]


def planks() -> Field:
    """Eight long boards side by side, the joints staggered."""
    strips = [np.roll(board((256, 32), k + 1), int(scatter(k, 1, 5) * 256), axis=0) for k in range(8)]
    return np.concatenate(strips, axis=1)


def crate() -> Field:
    """A face of a wooden crate: upright boards, a brace across them, a frame about them, nails."""
    size, rim = 512, 68
    widths = (rim, *[(size - 2 * rim) // 4] * 4, rim)
    picture = np.concatenate([board((size, width), 40 + k) for k, width in enumerate(widths)], axis=1) * 0.7
    y, x = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")

    length, half = 2 * size, 30
    across = (x - y) / np.sqrt(2)
    along = (x + y) / np.sqrt(2)
    on_brace = np.abs(across) < half
    brace = board((length, 2 * half), 61)[along.astype(int) + 150, np.clip(across + half, 0, 2 * half - 1).astype(int)]
    picture *= (0.45 + 0.55 * smoothstep(half, half + 16, np.abs(across - 4)))[..., None]
    picture = np.where(on_brace[..., None], brace * 0.92, picture)

    inside = np.minimum(np.minimum(x, size - 1 - x), np.minimum(y, size - 1 - y)) - rim
    # The frame throws a shadow, longer from its upper and left boards.
    depth = np.minimum(np.minimum(x - rim, y - rim) / 18, np.minimum(size - rim - x, size - rim - y) / 8)
    picture *= (0.4 + 0.6 * smoothstep(0, 1, depth))[..., None]
    upright = [board((size, rim), seed) for seed in (71, 72)]
    level = [np.swapaxes(board((size - 2 * rim, rim), seed), 0, 1) for seed in (73, 74)]
    picture[:, :rim], picture[:, -rim:] = upright
    picture[:rim, rim:-rim], picture[-rim:, rim:-rim] = level

    nails = [
        (a, b) for a in (20, 48, 463, 491) for b in (20, 48, 463, 491) if (a < 30 or a > 480) == (b < 30 or b > 480)
    ]
    nails += [(a, b) for a in (34, 477) for b in (114, 208, 302, 396)] + [(b, a) for a in (34, 477) for b in (170, 341)]
    for row, column in nails:
        away = np.hypot(y - row, x - column)
        picture *= (0.55 + 0.45 * smoothstep(4, 8, away))[..., None]
        head = (0.42 + 0.12 * np.clip((column - x + row - y) / 5, -1, 1))[..., None] * np.array([1, 1.02, 1.06])
        picture = np.where((away < 4.5)[..., None], head, picture)
    dirt = fractal((size, size), (4, 4), 90)
    picture *= (1 - 0.18 * smoothstep(0.1, 0.8, dirt) - 0.1 * smoothstep(12, -6, inside + rim))[..., None]
    return picture * 1.12


def brick() -> Field:
    """A brick wall in running bond: 12 courses of 4 bricks in one metre."""
    size, courses, bricks = 512, 12, 4
    y, x = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    wobble = 1.6 * fractal((size, size), (24, 24), 3, 2)
    course = y * courses // size
    along = (x * bricks / size + 0.5 * (course % 2)) % bricks
    number = along.astype(int)
    down = (y * courses / size % 1) * size / courses
    side = (along % 1) * size / bricks
    edge = np.minimum(np.minimum(side, size / bricks - side), np.minimum(down, size / courses - down)) + wobble
    body = smoothstep(2.5, 6.0, edge)

    rough = fractal((size, size), (32, 32), 8, 4)
    shade = scatter(course, number, 1)
    clay = coloured(
        shade + 0.22 * rough, ((0, (104, 46, 34)), (0.4, (140, 62, 44)), (0.75, (160, 78, 54)), (1, (178, 98, 70)))
    )
    clay = np.where((scatter(course, number, 2) > 0.93)[..., None], clay * 0.62, clay)
    clay *= (1 + 0.09 * grain((size, size), 4))[..., None]
    mortar = coloured(0.5 + 0.5 * rough, ((0, (138, 131, 120)), (1, (188, 181, 168)))) * 0.92
    mortar *= (1 + 0.06 * grain((size, size), 5))[..., None]
    picture = mortar * (1 - body[..., None]) + clay * body[..., None]
    return lit(picture, body + 0.15 * rough, 0.55)


def concrete() -> Field:
    """Grey concrete with pores and faint stains."""
    shape = (256, 256)
    cloud = fractal(shape, (3, 3), 21, 5)
    pores = smoothstep(0.62, 0.8, noise(shape, (40, 40), 30)) * smoothstep(-0.1, 0.3, noise(shape, (6, 6), 33))
    picture = coloured(0.5 + 0.35 * cloud, ((0, (128, 126, 121)), (1, (176, 174, 168))))
    picture *= (1 + 0.05 * grain(shape, 23) - 0.3 * pores)[..., None]
    return lit(picture, fractal(shape, (32, 32), 24, 2) - 2 * pores, 0.07)


def asphalt() -> Field:
    """A road: grit of all greys in dark tar, worn a little paler in places."""
    shape = (192, 192)
    worn, grit = fractal(shape, (3, 3), 131, 3), grain(shape, 132)
    stones = smoothstep(0.05, 0.75, noise(shape, (48, 48), 133))
    picture = coloured(0.5 + 0.4 * worn, ((0, (58, 58, 60)), (1, (76, 75, 75))))
    picture = picture * (1 + 0.16 * grit + 0.3 * stones)[..., None]
    return lit(picture, stones + 0.3 * grit, 0.12)


def plaster() -> Field:
    """An off-white wall with the marks of the trowel."""
    shape = (128, 128)
    strokes = fractal(shape, (4, 7), 51, 3)
    picture = coloured(0.5 + 0.5 * strokes, ((0, (214, 207, 190)), (1, (236, 230, 215))))
    return lit(picture * (1 + 0.015 * grain(shape, 52))[..., None], strokes, 0.2)


def grass() -> Field:
    """A meadow from above: short blades over dark ground."""
    size = 256
    patch = fractal((size, size), (3, 3), 61, 3)
    picture = coloured(0.5 + 0.4 * patch, ((0, (50, 70, 27)), (1, (62, 84, 32))))
    count = 9000
    blade = np.arange(count)
    x0, y0, lean, long, tone, kind = (scatter(blade, 0, 70 + k) for k in range(6))
    angle = (lean - 0.5) * 2.6
    green = coloured(tone, ((0, (60, 92, 32)), (0.5, (86, 118, 42)), (0.85, (118, 142, 58)), (1, (152, 160, 84))))
    green = np.where((kind > 0.965)[:, None], np.array([150, 138, 86]) / 255, green)
    for step in range(12):  # from the foot to the tip, so that tips lie over feet
        reach = step / 11 * (5 + 8 * long)
        column = (x0 * size + np.sin(angle) * reach).astype(int) % size
        row = (y0 * size - np.cos(angle) * reach).astype(int) % size
        picture[row, column] = green * (0.62 + 0.5 * step / 11)
    return picture * (1 + 0.06 * patch)[..., None]


def dirt() -> Field:
    """Trodden earth with stones in it."""
    size = 256
    y, x = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    cells = 14
    nearest = np.full((size, size), np.inf)
    owner = np.zeros((size, size))
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            row, column = y * cells // size + dy, x * cells // size + dx
            r, c = row % cells, column % cells
            fy, fx = (row + scatter(r, c, 81)) * size / cells, (column + scatter(r, c, 82)) * size / cells
            radius = 2.5 + 6.5 * scatter(r, c, 83) ** 2
            turn = scatter(r, c, 84) * np.pi
            a = (x - fx) * np.cos(turn) + (y - fy) * np.sin(turn)
            b = (y - fy) * np.cos(turn) - (x - fx) * np.sin(turn)
            away = np.hypot(a, b * 1.4) / radius
            owner = np.where(away < nearest, scatter(r, c, 85), owner)
            nearest = np.minimum(nearest, away)
    rough = fractal((size, size), (8, 8), 86, 5)
    nearest = nearest + 0.22 * fractal((size, size), (24, 24), 87, 2)
    stone = smoothstep(1.0, 0.86, nearest)
    earth = coloured(0.5 + 0.5 * rough, ((0, (82, 63, 43)), (0.5, (112, 88, 60)), (1, (142, 115, 82))))
    earth *= (1 + 0.14 * grain((size, size), 88) - 0.35 * smoothstep(1.5, 1.0, nearest))[..., None]
    rock = coloured(owner, ((0, (112, 104, 94)), (0.6, (142, 132, 118)), (1, (168, 160, 148))))
    rock *= (1 + 0.12 * rough + 0.05 * grain((size, size), 89))[..., None]
    height = np.sqrt(np.clip(1 - nearest**2, 0, 1)) + 0.25 * rough
    return lit(earth * (1 - stone[..., None]) + rock * stone[..., None], height, 0.8)


def roof() -> Field:
    """Rows of clay tiles, each row over the one below."""
    size, rows, tiles = 512, 4, 5
    y, x = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    row = y * rows // size
    down = y * rows / size % 1
    along = x * tiles / size
    number = along.astype(int)
    side = along % 1
    # A pantile: a wide trough, then a roll over the neighbour's edge.
    trough = -0.35 * np.sin(np.pi * np.clip(side / 0.64, 0, 1))
    roll = np.sin(np.pi * np.clip((side - 0.64) / 0.36, 0, 1))
    height = np.where(side < 0.64, trough, 0.9 * roll)
    rough = fractal((size, size), (16, 16), 91, 4)
    clay = coloured(
        0.15 + 0.7 * scatter(row, number, 92) + 0.2 * rough,
        ((0, (124, 60, 44)), (0.5, (156, 82, 58)), (1, (178, 106, 76))),
    )
    clay *= (1 + 0.07 * grain((size, size), 93) + 0.08 * height)[..., None]
    slope = np.roll(height, -1, axis=1) - height
    picture = clay * np.clip(1 + 7.5 * slope, 0.45, 1.35)[..., None]
    # The row above ends in a lip whose shadow follows the tiles' form.
    lip = down - 0.03 * height
    picture *= (1 - 0.68 * smoothstep(0.14, 0.0, lip) - 0.12 * smoothstep(0.5, 0.1, lip))[..., None]
    picture *= (1 + 0.3 * smoothstep(0.93, 0.97, lip) - 0.75 * smoothstep(0.975, 0.995, lip))[..., None]
    moss = smoothstep(0.25, 0.7, fractal((size, size), (4, 4), 95, 4)) * 0.3
    picture += moss[..., None] * (picture.mean(axis=2, keepdims=True) * np.array([0.72, 0.72, 0.44]) - picture)
    return picture


def steel() -> Field:
    """Brushed steel, the strokes level."""
    shape = (256, 256)
    strokes = noise(shape, (128, 3), 101) + 0.7 * noise(shape, (86, 6), 102) + 0.5 * noise(shape, (43, 2), 103)
    fine = noise(shape, (128, 24), 104)
    value = 0.5 + 0.2 * strokes + 0.1 * fine + 0.15 * fractal(shape, (2, 2), 105, 2)
    return coloured(value, ((0, (132, 137, 143)), (0.5, (166, 170, 175)), (1, (206, 209, 213))))


def rubber() -> Field:
    """Black rubber with a tread of slanting ribs."""
    size, ribs = 256, 8
    y, x = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    zigzag = np.abs((x / size * 2) % 1 - 0.5)
    across = (y * ribs / size + 1.6 * zigzag) % 1
    rib = smoothstep(0.06, 0.16, across) * smoothstep(0.72, 0.62, across)
    channel = smoothstep(0.012, 0.03, np.abs((x / size * 2) % 1 - 0.5))
    height = rib * channel
    picture = coloured(0.25 + 0.6 * height, ((0, (22, 22, 24)), (1, (58, 58, 61))))
    picture *= (1 + 0.16 * grain((size, size), 111) + 0.15 * fractal((size, size), (6, 6), 112))[..., None]
    return lit(picture, height, 0.7)


def paint() -> Field:
    """Red car paint with a fine flake."""
    shape = (128, 128)
    cloud = fractal(shape, (2, 2), 121, 2)
    flake = np.maximum(grain(shape, 122), 0) ** 6
    picture = coloured(0.5 + 0.3 * cloud, ((0, (164, 22, 22)), (1, (186, 30, 28))))
    return picture + 0.08 * flake[..., None]


TEXTURES: dict[str, Callable[[], Field]] = {
    texture.__name__: texture
    for texture in (asphalt, brick, concrete, crate, dirt, grass, paint, planks, plaster, roof, rubber, steel)
}
"""Every texture by name; the file is ``name.png``."""


def to_bytes(picture: Field) -> npt.NDArray[np.uint8]:
    """The picture as (height, width, 3) bytes."""
    return (np.clip(picture, 0, 1) * 255 + 0.5).astype(np.uint8)
