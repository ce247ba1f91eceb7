"""Motion: a background that follows, boxes of what moved, sums of a window's gradients, block motion, blobs by size."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16

SIDE = 8


@kernel
def follow_background(frame: u8[:], background: u16[:], moved: u8[:], n: i32, threshold: i32) -> i32:
    count = 0
    for i in range(n):
        level = background[i]
        off = (frame[i] << 8) - level
        if abs(off) > threshold << 8:
            moved[i] = 1
            count += 1
            background[i] = level + (off >> 6)
        else:
            moved[i] = 0
            background[i] = level + (off >> 3)
    return count


@kernel
def moved_boxes(moved: u8[:], w: i32, h: i32, least: i32, boxes: u8[:]) -> i32:
    count = 0
    for top in range(0, h, SIDE):
        for left in range(0, w, SIDE):
            inside = 0
            low = 255
            high = 0
            for y in range(top, min(top + SIDE, h)):
                for x in range(left, min(left + SIDE, w)):
                    if moved[y * w + x] != 0:
                        inside += 1
                        low = min(low, x)
                        high = max(high, x)
            if inside >= least:
                boxes[3 * count] = low
                boxes[3 * count + 1] = high
                boxes[3 * count + 2] = top
                count += 1
    return count


@kernel
def gradient_sums(now: u8[:], before: u8[:], w: i32, x0: i32, y0: i32, reach: i32, sums: i32[:]) -> None:
    xx = 0
    xy = 0
    yy = 0
    xt = 0
    yt = 0
    for y in range(y0 - reach, y0 + reach + 1):
        for x in range(x0 - reach, x0 + reach + 1):
            at = y * w + x
            gx = (before[at + 1] - before[at - 1]) >> 1
            gy = (before[at + w] - before[at - w]) >> 1
            gt = now[at] - before[at]
            xx += gx * gx
            xy += gx * gy
            yy += gy * gy
            xt += gx * gt
            yt += gy * gt
    sums[0] = xx
    sums[1] = xy
    sums[2] = yy
    sums[3] = xt
    sums[4] = yt


@kernel
def block_difference(a: u8[:], at: i32, b: u8[:], there: i32, w: i32, limit: i32) -> i32:
    total = 0
    for _y in range(8):
        for x in range(8):
            total += abs(a[at + x] - b[there + x])
        if total > limit:
            return total
        at += w
        there += w
    return total


@kernel
def block_motion(now: u8[:], before: u8[:], w: i32, x: i32, y: i32, reach: i32, vector: i32[:]) -> i32:
    best = 0x7FFFFFFF
    for dy in range(-reach, reach + 1):
        for dx in range(-reach, reach + 1):
            cost = block_difference(now, y * w + x, before, (y + dy) * w + x + dx, w, best)
            if cost < best:
                best = cost
                vector[0] = dx
                vector[1] = dy
    return best


@kernel
def largest_first(areas: u16[:], xs: i16[:], ys: i16[:], n: i32) -> None:
    for i in range(n - 1):
        top = i
        for j in range(i + 1, n):
            if areas[j] > areas[top]:
                top = j
        if top != i:
            area = areas[i]
            areas[i] = areas[top]
            areas[top] = area
            x = xs[i]
            xs[i] = xs[top]
            xs[top] = x
            y = ys[i]
            ys[i] = ys[top]
            ys[top] = y


def play_background(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    background, moved = np.full(250, 100 << 8, np.uint16), np.zeros(250, np.uint8)
    counts = []
    for _ in range(3):
        frame = (90 + lcg.scaled(250, 20, 0, "i4") + 60 * (lcg.bytes(250) > 220)).astype(np.uint8)
        counts.append(word(run(frame, background, moved, 250, 20)))
    return background, moved, *counts


def play_boxes(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    boxes = np.zeros(60, np.uint8)
    count = run((lcg.bytes(40 * 30) > 200).astype(np.uint8), 40, 30, 12, boxes)
    return boxes, word(count)


def play_gradients(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    before = lcg.bytes(32 * 32)
    sums = np.zeros((4, 5), np.int32)
    for i, each in enumerate(sums):
        run(np.roll(before, 1), before, 32, 10 + 3 * i, 12 + 2 * i, 7, each)
    return (sums.ravel(),)


def play_motion(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    before = np.convolve(lcg.scaled(32 * 32 + 2, 250, 0, "i4"), [1, 2, 1], "valid") // 4
    now = np.roll(before, 32 * 2 - 1).astype(np.uint8)
    vector = np.zeros(2, np.int32)
    best = run(now, before.astype(np.uint8), 32, 12, 11, 3, vector)
    return vector, word(best)


def play_largest(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    areas = lcg.scaled(40, 5000, 1, "u2")
    xs, ys = lcg.scaled(40, 320), lcg.scaled(40, 240)
    run(areas, xs, ys, 40)
    return areas, xs, ys


CASES = (
    Case(follow_background, 2311, play_background, exported=True),
    Case(moved_boxes, 2312, play_boxes, exported=True),
    Case(gradient_sums, 2313, play_gradients, exported=True),
    Case(block_motion, 2314, play_motion, exported=True),
    Case(largest_first, 2315, play_largest, exported=True),
)
