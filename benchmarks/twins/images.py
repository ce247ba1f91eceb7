"""Pictures: relief, the largest of four pixels, edges kept by their neighbours, planes of a UYVY line, a lens's dark corners."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16

STRONG, WEAK, KEPT = 2, 1, 3


@kernel
def emboss_rows(src: u8[:], dst: u8[:], width: i32, height: i32, depth: i32) -> None:
    for y in range(1, height - 1):
        for x in range(1, width - 1):
            at = y * width + x
            light = src[at - width - 1] + src[at - width] + src[at - 1]
            shade = src[at + 1] + src[at + width] + src[at + width + 1]
            value = 128 + (((light - shade) * depth) >> 3)
            dst[at] = min(max(value, 0), 255)


@kernel
def pool_max(src: u8[:], w: i32, h: i32, dst: u8[:]) -> None:
    o = 0
    for y in range(0, h, 2):
        p = y * w
        q = p + w
        for _ in range(w >> 1):
            upper = max(src[p], src[p + 1])
            lower = max(src[q], src[q + 1])
            dst[o] = max(upper, lower)
            o += 1
            p += 2
            q += 2


@kernel
def keep_connected(row: u8[:], n: i32) -> i32:
    kept = 0
    last = 0
    for x in range(n):
        if row[x] == STRONG or (row[x] == WEAK and last != 0):
            row[x] = KEPT
            last = 1
        elif row[x] == 0:
            last = 0
    last = 0
    x = n - 1
    while x >= 0:
        if row[x] == KEPT:
            last = 1
        elif row[x] == WEAK and last != 0:
            row[x] = KEPT
        else:
            last = 0
            row[x] = 0
        if row[x] == KEPT:
            kept += 1
        x -= 1
    return kept


@kernel
def split_uyvy(line: u8[:], luma: u8[:], blue: i16[:], red: i16[:], pairs: i32) -> None:
    for i in range(pairs):
        u = line[4 * i] - 128
        v = line[4 * i + 2] - 128
        luma[2 * i] = line[4 * i + 1]
        luma[2 * i + 1] = line[4 * i + 3]
        blue[i] = (u * 454) >> 8
        red[i] = (v * 359) >> 8


@kernel
def brighten_corners(pixels: u8[:], width: i32, height: i32, gains: u16[:]) -> None:
    cx = width >> 1
    cy = height >> 1
    i = 0
    for y in range(height):
        dy = y - cy
        down = dy * dy
        for x in range(width):
            dx = x - cx
            r = (dx * dx + down) >> 4
            v = (pixels[i] * i32(gains[r])) >> 8
            if v > 255:
                v = 255
            pixels[i] = v
            i += 1


def play_emboss(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(32 * 18, np.uint8)
    run(lcg.bytes(32 * 18), dst, 32, 18, 5)
    return (dst,)


def play_pool(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(20 * 12, np.uint8)
    run(lcg.bytes(40 * 24), 40, 24, dst)
    return (dst,)


def play_connected(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    row = np.array([(0, 1, 1, 1, 2)[lcg.below(5)] if lcg.below(4) else 0 for _ in range(320)], np.uint8)
    kept = run(row, 320)
    return row, np.array([kept], np.int32)


def play_split(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    luma, blue, red = np.zeros(240, np.uint8), np.zeros(120, np.int16), np.zeros(120, np.int16)
    run(lcg.bytes(480), luma, blue, red, 120)
    return luma, blue, red


def play_corners(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    pixels = lcg.bytes(40 * 30)
    run(pixels, 40, 30, (256 + 8 * np.arange(64)).astype(np.uint16))
    return (pixels,)


CASES = (
    Case(emboss_rows, 2701, play_emboss, exported=True),
    Case(pool_max, 2702, play_pool, exported=True),
    Case(keep_connected, 2703, play_connected, exported=True),
    Case(split_uyvy, 2704, play_split, exported=True),
    Case(brighten_corners, 2705, play_corners, exported=True),
)
