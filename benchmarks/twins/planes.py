"""Grey pictures: the commonest level, a morphological gradient, a window through a table, means from an integral image, saturated sums."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u32


@kernel
def commonest_level(picture: u8[:], n: i32, counts: i32[:]) -> i32:
    for level in range(256):
        counts[level] = 0
    for i in range(n):
        counts[picture[i]] += 1
    best = 0
    for level in range(1, 256):
        if counts[level] > counts[best]:
            best = level
    return best


@kernel
def border_strength(above: u8[:], here: u8[:], below: u8[:], w: i32, out: u8[:]) -> None:
    out[0] = 0
    out[w - 1] = 0
    for x in range(1, w - 1):
        high = max(above[x], below[x])
        low = min(above[x], below[x])
        for near in range(x - 1, x + 2):
            high = max(high, here[near])
            low = min(low, here[near])
        out[x] = high - low


@kernel
def window_by_table(
    picture: u8[:], w: i32, table: u8[:], x0: i32, y0: i32, wide: i32, high: i32, out: u8[:]
) -> i32:
    total = 0
    for y in range(high):
        source = (y0 + y) * w + x0
        target = y * wide
        for x in range(wide):
            value = table[picture[source + x]]
            out[target + x] = value
            total += value
    return total


@kernel
def means_around(sums: u32[:], w: i32, h: i32, reach: i32, out: u8[:]) -> None:
    stride = w + 1
    for y in range(h):
        top = max(y - reach, 0)
        bottom = min(y + reach + 1, h)
        for x in range(w):
            left = max(x - reach, 0)
            right = min(x + reach + 1, w)
            area = u32((bottom - top) * (right - left))
            total = sums[bottom * stride + right] - sums[top * stride + right]
            total += sums[top * stride + left] - sums[bottom * stride + left]
            out[y * w + x] = total // area


@kernel
def brighten(picture: u8[:], light: u8[:], n: i32, gain: i32) -> i32:
    clipped = 0
    for i in range(n):
        value = picture[i] + ((light[i] * gain) >> 6)
        if value > 255:
            value = 255
            clipped += 1
        picture[i] = value
    return clipped


def play_commonest(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    counts = np.zeros(256, np.int32)
    best = run(lcg.bytes(900), 900, counts)
    return counts, word(best)


def play_border(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    rows, out = [lcg.bytes(200) for _ in range(3)], np.zeros(200, np.uint8)
    run(*rows, 200, out)
    return (out,)


def play_window(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture, table, out = lcg.bytes(48 * 40), lcg.bytes(256), np.zeros(24 * 20, np.uint8)
    total = run(picture, 48, table, 9, 7, 24, 20, out)
    return out, word(total)


def play_means(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    w, h = 20, 12
    picture, out = lcg.bytes(w * h).reshape(h, w), np.zeros(w * h, np.uint8)
    sums = np.zeros((h + 1, w + 1), np.uint32)
    sums[1:, 1:] = picture.cumsum(0).cumsum(1)
    run(sums.ravel(), w, h, 2, out)
    return (out,)


def play_brighten(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture, light = lcg.bytes(600), lcg.bytes(600)
    clipped = run(picture, light, 600, 45)
    return picture, word(clipped)


CASES = (
    Case(commonest_level, 2701, play_commonest, exported=True),
    Case(border_strength, 2702, play_border, exported=True),
    Case(window_by_table, 2703, play_window, exported=True),
    Case(means_around, 2704, play_means, exported=True),
    Case(brighten, 2705, play_brighten, exported=True),
)
