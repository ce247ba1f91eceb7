"""Shapes in a picture: columns, runs, clipped lines, overlapping boxes, the outline of a circle."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.api import quotient
from bfsim.kernel import i16, i32, kernel, u8


@kernel
def column_profile(image: u8[:], w: i32, h: i32, sums: i32[:]) -> i32:
    for x in range(w):
        sums[x] = 0
    for y in range(h):
        for x in range(w):
            sums[x] += image[y * w + x]
    best = 0
    for x in range(1, w):
        if sums[x] > sums[best]:
            best = x
    return best


@kernel
def runs_of_row(row: u8[:], n: i32, colour: i32, shortest: i32, starts: i16[:], ends: i16[:]) -> i32:
    found = 0
    x = 0
    while x < n:
        while x < n and row[x] != colour:
            x += 1
        start = x
        while x < n and row[x] == colour:
            x += 1
        if x - start >= shortest:
            starts[found] = start
            ends[found] = x - 1
            found += 1
    return found


@kernel
def outcode(x: i32, y: i32, w: i32, h: i32) -> i32:
    code = 0
    if x < 0:
        code = 1
    elif x >= w:
        code = 2
    if y < 0:
        code |= 4
    elif y >= h:
        code |= 8
    return code


@kernel
def clip_line(ends: i32[:], w: i32, h: i32) -> i32:
    x0 = ends[0]
    y0 = ends[1]
    x1 = ends[2]
    y1 = ends[3]
    code0 = outcode(x0, y0, w, h)
    code1 = outcode(x1, y1, w, h)
    while (code0 | code1) != 0:
        if (code0 & code1) != 0:
            return 0
        code = code0 if code0 != 0 else code1
        if (code & 8) != 0:
            x = x0 + quotient((x1 - x0) * (h - 1 - y0), y1 - y0)
            y = h - 1
        elif (code & 4) != 0:
            x = x0 + quotient((x1 - x0) * (0 - y0), y1 - y0)
            y = 0
        elif (code & 2) != 0:
            y = y0 + quotient((y1 - y0) * (w - 1 - x0), x1 - x0)
            x = w - 1
        else:
            y = y0 + quotient((y1 - y0) * (0 - x0), x1 - x0)
            x = 0
        if code == code0:
            x0 = x
            y0 = y
            code0 = outcode(x0, y0, w, h)
        else:
            x1 = x
            y1 = y
            code1 = outcode(x1, y1, w, h)
    ends[0] = x0
    ends[1] = y0
    ends[2] = x1
    ends[3] = y1
    return 1


@kernel
def overlapping_boxes(left: i16[:], top: i16[:], right: i16[:], bottom: i16[:], n: i32, pairs: u8[:]) -> i32:
    found = 0
    for i in range(n - 1):
        for j in range(i + 1, n):
            if left[i] > right[j] or left[j] > right[i]:
                continue
            if top[i] > bottom[j] or top[j] > bottom[i]:
                continue
            pairs[2 * found] = i
            pairs[2 * found + 1] = j
            found += 1
    return found


@kernel
def plot(image: u8[:], w: i32, h: i32, x: i32, y: i32) -> None:
    if 0 <= x < w and 0 <= y < h:
        image[y * w + x] = 255


@kernel
def circle_outline(image: u8[:], w: i32, h: i32, cx: i32, cy: i32, radius: i32) -> None:
    x = radius
    y = 0
    error = 1 - radius
    while x >= y:
        plot(image, w, h, cx + x, cy + y)
        plot(image, w, h, cx - x, cy + y)
        plot(image, w, h, cx + x, cy - y)
        plot(image, w, h, cx - x, cy - y)
        plot(image, w, h, cx + y, cy + x)
        plot(image, w, h, cx - y, cy + x)
        plot(image, w, h, cx + y, cy - x)
        plot(image, w, h, cx - y, cy - x)
        y += 1
        if error < 0:
            error += 2 * y + 1
        else:
            x -= 1
            error += 2 * (y - x) + 1


def play_profile(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    sums = np.zeros(40, np.int32)
    best = run(lcg.bytes(40 * 30), 40, 30, sums)
    return sums, word(best)


def play_runs(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    row = np.repeat(lcg.scaled(80, 4, kind="u1"), lcg.scaled(80, 12, 1))
    starts, ends = np.zeros(200, np.int16), np.zeros(200, np.int16)
    found = run(row, len(row), 2, 3, starts, ends)
    return starts, ends, word(found)


def play_clip(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    lines = [lcg.scaled(4, 300, -80, "i4") for _ in range(40)]
    seen = sum(run(line, 160, 120) for line in lines)
    return *lines, word(seen)


def play_boxes(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    left, top = lcg.scaled(30, 200), lcg.scaled(30, 150)
    right, bottom = left + lcg.scaled(30, 60), top + lcg.scaled(30, 60)
    pairs = np.zeros(2 * 30 * 29, np.uint8)
    found = run(left, top, right, bottom, 30, pairs)
    return pairs, word(found)


def play_circles(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image = np.zeros(64 * 48, np.uint8)
    for _ in range(8):
        run(image, 64, 48, lcg.below(64), lcg.below(48), 3 + lcg.below(20))
    return (image,)


CASES = (
    Case(column_profile, 2031, play_profile, exported=True),
    Case(runs_of_row, 2032, play_runs, exported=True),
    Case(clip_line, 2033, play_clip, exported=True),
    Case(overlapping_boxes, 2034, play_boxes, exported=True),
    Case(circle_outline, 2035, play_circles, exported=True),
)
