"""Rows of a picture: means of colours, saturation, runs, a stretched histogram, curves between points, dilation, masks in bits."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u32


@kernel
def grey_mean_row(rgb: u8[:], out: u8[:], n: i32) -> None:
    for x in range(n):
        out[x] = (rgb[3 * x] + rgb[3 * x + 1] + rgb[3 * x + 2]) // 3


@kernel
def saturation_row(rgb: u8[:], out: u8[:], n: i32) -> None:
    for x in range(n):
        r = rgb[3 * x]
        g = rgb[3 * x + 1]
        b = rgb[3 * x + 2]
        top = max(r, g, b)
        bottom = min(r, g, b)
        out[x] = 0 if top == 0 else (top - bottom) * 255 // top


@kernel
def bright_runs(row: u8[:], starts: i16[:], lengths: i16[:], n: i32, limit: i32) -> i32:
    count = 0
    x = 0
    while x < n:
        if row[x] >= limit:
            start = x
            while x < n and row[x] >= limit:
                x += 1
            if x - start >= 2:
                starts[count] = start
                lengths[count] = x - start
                count += 1
        else:
            x += 1
    return count


@kernel
def cumulative_lut(picture: u8[:], bins: u32[:], lut: u8[:], n: i32) -> None:
    for level in range(256):
        bins[level] = 0
    for i in range(n):
        bins[picture[i]] += 1
    total: u32 = 0
    for level in range(256):
        total += bins[level]
        lut[level] = (total * 255) // u32(n)


@kernel
def curve17_row(src: u8[:], curve: i16[:], dst: i16[:], n: i32) -> None:
    for x in range(n):
        v = src[x]
        k = v >> 4
        part = v & 15
        low = curve[k]
        dst[x] = low + (((curve[k + 1] - low) * part + 8) >> 4)


@kernel
def dilate_grey_row(above: u8[:], here: u8[:], below: u8[:], out: u8[:], n: i32) -> None:
    left = max(above[0], here[0], below[0])
    middle = left
    for x in range(n - 1):
        right = max(above[x + 1], here[x + 1], below[x + 1])
        out[x] = max(left, middle, right)
        left = middle
        middle = right
    out[n - 1] = max(left, middle)


@kernel
def mask_words(row: u8[:], words: u32[:], n: i32, limit: i32) -> None:
    for w in range(n // 32):
        bits: u32 = 0
        for b in range(32):
            if row[32 * w + b] > limit:
                bits |= u32(1) << b
        words[w] = bits


@kernel
def widest_gap(row: u8[:], n: i32) -> i32:
    best = 0
    best_at = -1
    run = 0
    for x in range(n):
        if row[x]:
            run = 0
        else:
            run += 1
            if run > best:
                best = run
                best_at = x - run + 1
    return (best_at << 16) | best


def play_grey(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(320, np.uint8)
    run(lcg.bytes(960), out, 320)
    return (out,)


def play_runs(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    row = np.array([200 if lcg.below(40) < 25 else 30 for _ in range(80)], np.uint8).repeat(4)
    starts, lengths = np.zeros(160, np.int16), np.zeros(160, np.int16)
    found = run(row, starts, lengths, 320, 128)
    return starts, lengths, word(found)


def play_cumulative(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    bins, lut = np.zeros(256, np.uint32), np.zeros(256, np.uint8)
    run((lcg.bytes(1600) // 2 + 40).astype(np.uint8), bins, lut, 1600)
    return bins, lut


def play_curve(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    curve, dst = np.array([k * k * 16 - 2000 for k in range(17)], np.int16), np.zeros(320, np.int16)
    run(lcg.bytes(320), curve, dst, 320)
    return (dst,)


def play_dilate(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(320, np.uint8)
    run(lcg.bytes(320), lcg.bytes(320), lcg.bytes(320), out, 320)
    return (out,)


def play_mask(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    words = np.zeros(10, np.uint32)
    run(lcg.bytes(320), words, 320, 127)
    return (words,)


def play_gap(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    row = np.array([1 if lcg.below(8) == 0 else 0 for _ in range(320)], np.uint8)
    return (word(run(row, 320)),)


CASES = (
    Case(grey_mean_row, 1801, play_grey, exported=True),
    Case(saturation_row, 1802, play_grey, exported=True),
    Case(bright_runs, 1803, play_runs, exported=True),
    Case(cumulative_lut, 1804, play_cumulative, exported=True),
    Case(curve17_row, 1805, play_curve, exported=True),
    Case(dilate_grey_row, 1806, play_dilate, exported=True),
    Case(mask_words, 1807, play_mask, exported=True),
    Case(widest_gap, 1808, play_gap, exported=True),
)
