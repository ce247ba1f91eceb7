"""Pictures: sharpness, colours, the longest run, a fill by a queue, the shift between two rows, points before a camera."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16

FAR = 999


@kernel
def sharpen_luma(src: u8[:], dst: u8[:], w: i32, h: i32, amount: i32) -> None:
    for y in range(1, h - 1):
        p = y * w + 1
        for _ in range(w - 2):
            detail = 4 * src[p] - src[p - 1] - src[p + 1] - src[p - w] - src[p + w]
            v = src[p] + ((detail * amount) >> 5)
            if v < 0:
                v = 0
            if v > 255:
                v = 255
            dst[p] = v
            p += 1


@kernel
def rgb_to_ycc(rgb: u8[:], y: u8[:], cb: u8[:], cr: u8[:], n: i32) -> None:
    for i in range(n):
        r = i32(rgb[3 * i])
        g = i32(rgb[3 * i + 1])
        b = i32(rgb[3 * i + 2])
        y[i] = (77 * r + 150 * g + 29 * b) >> 8
        cb[i] = ((-43 * r - 85 * g + 128 * b) >> 8) + 128
        cr[i] = ((128 * r - 107 * g - 21 * b) >> 8) + 128


@kernel
def longest_run(row: u8[:], n: i32, level: i32, place: i32[:]) -> i32:
    best = 0
    length = 0
    for x in range(n):
        if row[x] >= level:
            length += 1
            if length > best:
                best = length
                place[0] = x - length + 1
        else:
            length = 0
    return best


@kernel
def spread_ink(cells: u8[:], w: i32, h: i32, queue: u16[:], start: i32) -> i32:
    head = 0
    tail = 1
    queue[0] = start
    cells[start] = 2
    while head < tail:
        at = i32(queue[head])
        head += 1
        x = at % w
        if x > 0 and cells[at - 1] == 0:
            cells[at - 1] = 2
            queue[tail] = at - 1
            tail += 1
        if x < w - 1 and cells[at + 1] == 0:
            cells[at + 1] = 2
            queue[tail] = at + 1
            tail += 1
        if at >= w and cells[at - w] == 0:
            cells[at - w] = 2
            queue[tail] = at - w
            tail += 1
        if at < w * (h - 1) and cells[at + w] == 0:
            cells[at + w] = 2
            queue[tail] = at + w
            tail += 1
    return tail


@kernel
def best_shift(left: u8[:], right: u8[:], n: i32, most: i32, costs: u16[:]) -> i32:
    best = FAR * FAR
    found = -1
    for d in range(most):
        total = 0
        for x in range(most, n):
            total += abs(left[x] - right[x - d])
        costs[d] = min(total, 65535)
        if total < best:
            best = total
            found = d
    return found


@kernel
def project_points(points: i16[:], count: i32, focal: i32, image: i16[:]) -> i32:
    seen = 0
    for i in range(count):
        z = i32(points[3 * i + 2])
        if z < 16:
            continue
        u = focal * points[3 * i] // z
        v = focal * points[3 * i + 1] // z
        if abs(u) > 160 or abs(v) > 120:
            continue
        image[2 * seen] = u + 160
        image[2 * seen + 1] = v + 120
        seen += 1
    return seen


def play_sharpen(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(36 * 16, np.uint8)
    run(lcg.bytes(36 * 16), dst, 36, 16, 9)
    return (dst,)


def play_ycc(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    planes = [np.zeros(160, np.uint8) for _ in range(3)]
    run(lcg.bytes(480), *planes, 160)
    return tuple(planes)


def play_run(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    place = np.zeros(1, np.int32)
    best = run(lcg.bytes(320), 320, 60, place)
    return place, word(best)


def play_ink(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    cells = np.array([lcg.below(4) == 0 for _ in range(24 * 18)], np.uint8)
    filled = run(cells, 24, 18, np.zeros(24 * 18, np.uint16), 9 * 24 + 12)
    return cells, word(filled)


def play_shift(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    right = lcg.bytes(100)
    left, costs = np.roll(right, 7), np.zeros(16, np.uint16)
    return costs, word(run(left, right, 100, 16, costs))


def play_project(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    points, image = lcg.scaled(180, 600, -200), np.zeros(120, np.int16)
    seen = run(points, 60, 200, image)
    return image, word(seen)


CASES = (
    Case(sharpen_luma, 2751, play_sharpen, exported=True),
    Case(rgb_to_ycc, 2752, play_ycc, exported=True),
    Case(longest_run, 2753, play_run, exported=True),
    Case(spread_ink, 2755, play_ink, exported=True),
    Case(best_shift, 2760, play_shift, exported=True),
    Case(project_points, 2759, play_project, exported=True),
)
