"""Plane geometry and maps: a hull, a polygon, rays through a grid, a quarter turn, a sprite."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8


@kernel
def turn(xs: i16[:], ys: i16[:], a: i32, b: i32, c: i32) -> i32:
    return (xs[b] - xs[a]) * (ys[c] - ys[a]) - (ys[b] - ys[a]) * (xs[c] - xs[a])


@kernel
def lower_hull(xs: i16[:], ys: i16[:], n: i32, hull: u8[:]) -> i32:
    top = 0
    for i in range(n):
        while top >= 2 and turn(xs, ys, hull[top - 2], hull[top - 1], i) <= 0:
            top -= 1
        hull[top] = i
        top += 1
    return top


@kernel
def inside_polygon(xs: i16[:], ys: i16[:], n: i32, x: i32, y: i32) -> i32:
    inside = 0
    j = n - 1
    for i in range(n):
        upward = ys[i] <= y < ys[j]
        if upward or ys[j] <= y < ys[i]:
            side = (xs[j] - xs[i]) * (y - ys[i]) - (x - xs[i]) * (ys[j] - ys[i])
            if (upward and side > 0) or (not upward and side < 0):
                inside ^= 1
        j = i
    return inside


@kernel
def ray_length(grid: u8[:], w: i32, h: i32, x: i32, y: i32, dx: i32, dy: i32) -> i32:
    steps = 0
    while steps < 200:
        x += dx
        y += dy
        column = x >> 8
        row = y >> 8
        if column < 0 or row < 0 or column >= w or row >= h:
            break
        if grid[row * w + column] != 0:
            return steps
        steps += 1
    return -1


@kernel
def quarter_turn(image: u8[:], w: i32, h: i32, out: u8[:]) -> None:
    for y in range(h):
        for x in range(w):
            out[x * h + (h - 1 - y)] = image[y * w + x]


@kernel
def blit_sprite(screen: u8[:], w: i32, h: i32, sprite: u8[:], sw: i32, sh: i32, x0: i32, y0: i32) -> i32:
    hits = 0
    for sy in range(sh):
        y = y0 + sy
        if y < 0 or y >= h:
            continue
        for sx in range(sw):
            x = x0 + sx
            if x < 0 or x >= w:
                continue
            colour = sprite[sy * sw + sx]
            if colour == 0:
                continue
            at = y * w + x
            if screen[at] != 0:
                hits += 1
            screen[at] = colour
    return hits


def play_hull(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    points = sorted({(lcg.below(500), lcg.below(500)) for _ in range(120)})
    xs, ys = (np.array(each, np.int16) for each in zip(*points, strict=True))
    hull = np.zeros(128, np.uint8)
    top = run(xs, ys, len(points), hull)
    return hull, word(top)


def play_polygon(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    angles = np.arange(20) * np.pi / 10
    radii = lcg.scaled(20, 60, 30)
    xs, ys = (np.round(radii * f(angles)).astype(np.int16) for f in (np.cos, np.sin))
    found = [run(xs, ys, 20, lcg.below(160) - 80, lcg.below(160) - 80) for _ in range(30)]
    return (np.array(found, np.int32),)


def play_rays(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    grid = np.array([lcg.below(40) == 0 for _ in range(48 * 36)], np.uint8)
    directions = [(lcg.below(512) - 256, lcg.below(512) - 256) for _ in range(40)]
    return (np.array([run(grid, 48, 36, 24 << 8, 18 << 8, *each) for each in directions], np.int32),)


def play_turn(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(40 * 30, np.uint8)
    run(lcg.bytes(40 * 30), 40, 30, out)
    return (out,)


def play_sprites(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    screen, hits = np.zeros(60 * 40, np.uint8), 0
    sprite = np.array([max(lcg.below(8) - 3, 0) for _ in range(12 * 10)], np.uint8)
    for _ in range(8):
        hits += run(screen, 60, 40, sprite, 12, 10, lcg.below(70) - 10, lcg.below(50) - 8)
    return screen, word(hits)


CASES = (
    Case(lower_hull, 2121, play_hull, exported=True),
    Case(inside_polygon, 2122, play_polygon, exported=True),
    Case(ray_length, 2123, play_rays, exported=True),
    Case(quarter_turn, 2124, play_turn, exported=True),
    Case(blit_sprite, 2125, play_sprites, exported=True),
)
