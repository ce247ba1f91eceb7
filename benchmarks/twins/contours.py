"""Contours of a picture: gradients with their directions, ridges, weak edges beside strong ones, a box filter, equal histograms."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16


@kernel
def gradient_codes(picture: u8[:], width: i32, height: i32, size: u8[:], code: u8[:]) -> None:
    for y in range(1, height - 1):
        for x in range(1, width - 1):
            at = y * width + x
            up = at - width
            down = at + width
            gx = picture[up + 1] + 2 * picture[at + 1] + picture[down + 1]
            gx -= picture[up - 1] + 2 * picture[at - 1] + picture[down - 1]
            gy = picture[down - 1] + 2 * picture[down] + picture[down + 1]
            gy -= picture[up - 1] + 2 * picture[up] + picture[up + 1]
            ax = abs(gx)
            ay = abs(gy)
            size[at] = min((ax + ay) >> 2, 255)
            if 5 * ay < 2 * ax:
                code[at] = 0
            elif 2 * ay > 5 * ax:
                code[at] = 2
            elif (gx ^ gy) < 0:
                code[at] = 3
            else:
                code[at] = 1


@kernel
def keep_ridges(size: u8[:], code: u8[:], width: i32, height: i32, least: i32, out: u8[:]) -> i32:
    kept = 0
    for y in range(1, height - 1):
        row = y * width
        for x in range(1, width - 1):
            here = size[row + x]
            if here < least:
                out[row + x] = 0
                continue
            way = code[row + x]
            step = 1
            if way == 1:
                step = width + 1
            elif way == 2:
                step = width
            elif way == 3:
                step = width - 1
            if here >= size[row + x - step] and here > size[row + x + step]:
                out[row + x] = here
                kept += 1
            else:
                out[row + x] = 0
    return kept


@kernel
def join_weak(edges: u8[:], width: i32, height: i32, low: i32, high: i32, most: i32) -> i32:
    sweeps = 0
    changed = True
    while changed and sweeps < most:
        changed = False
        sweeps += 1
        for y in range(1, height - 1):
            for x in range(1, width - 1):
                i = y * width + x
                if edges[i] < low or edges[i] >= high:
                    continue
                best = max(max(edges[i - 1], edges[i + 1]), max(edges[i - width], edges[i + width]))  # noqa: PLW3301 -- so it was measured
                if best >= high:
                    edges[i] = high
                    changed = True
    return sweeps


@kernel
def box_filter(
    picture: u8[:], width: i32, height: i32, radius: i32, factor: i32, sums: u16[:], out: u8[:]
) -> None:
    for x in range(width):
        total = 0
        for y in range(2 * radius):
            total += picture[y * width + x]
        sums[x] = total
    for y in range(radius, height - radius):
        below = (y + radius) * width
        above = (y - radius) * width
        for x in range(width):
            sums[x] += picture[below + x]
        total = 0
        for x in range(2 * radius):
            total += sums[x]
        for x in range(radius, width - radius):
            total += sums[x + radius]
            out[y * width + x] = (total * factor) >> 16
            total -= sums[x - radius]
        for x in range(width):
            sums[x] -= picture[above + x]


@kernel
def equalise_in_place(picture: u8[:], n: i32, tally: i32[:], table: u8[:]) -> None:
    for i in range(256):
        tally[i] = 0
    for i in range(n):
        tally[picture[i]] += 1
    first = 0
    while first < 255 and tally[first] == 0:
        first += 1
    rest = n - tally[first]
    factor = (255 << 16) // rest if rest > 0 else 0
    total = 0
    for level in range(first + 1, 256):
        total += tally[level]
        table[level] = (total * factor + 0x8000) >> 16
    table[first] = 0
    for i in range(n):
        picture[i] = table[picture[i]]


def scene(lcg: Lcg, width: int, height: int) -> Array:
    y, x = np.mgrid[:height, :width]
    bright = 40 + 90 * ((x - 14) ** 2 + (y - 10) ** 2 < 60) + 60 * (x + 2 * y > 50)
    return (bright + lcg.scaled(width * height, 16).reshape(height, width)).astype(np.uint8).ravel()


def play_gradients(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    size, code = (np.zeros(32 * 20, np.uint8) for _ in range(2))
    run(scene(lcg, 32, 20), 32, 20, size, code)
    return size, code


def play_ridges(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(32 * 20, np.uint8)
    code = lcg.scaled(32 * 20, 4, 0, "u1")
    kept = run(scene(lcg, 32, 20), code, 32, 20, 60, out)
    return out, word(kept)


def play_weak(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    edges = lcg.bytes(28 * 18)
    sweeps = run(edges, 28, 18, 70, 225, 5)
    return edges, word(sweeps)


def play_box(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(40 * 16, np.uint8)
    run(scene(lcg, 40, 16), 40, 16, 2, 65536 // 25, np.zeros(40, np.uint16), out)
    return (out,)


def play_equalise_in_place(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture = scene(lcg, 32, 20)
    run(picture, 640, np.zeros(256, np.int32), np.zeros(256, np.uint8))
    return (picture,)


CASES = (
    Case(gradient_codes, 2601, play_gradients, exported=True),
    Case(keep_ridges, 2602, play_ridges, exported=True),
    Case(join_weak, 2603, play_weak, exported=True),
    Case(box_filter, 2604, play_box, exported=True),
    Case(equalise_in_place, 2605, play_equalise_in_place, exported=True),
)
