"""One more of each kind: cocktail sort, an unsharp mask, a fill by level, colour classes, a transpose of bits."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32


@kernel
def cocktail_sort(a: u8[:], n: i32) -> None:
    left = 0
    right = n - 1
    while left < right:
        last = left
        for i in range(left, right):
            if a[i] > a[i + 1]:
                t = a[i]
                a[i] = a[i + 1]
                a[i + 1] = t
                last = i
        right = last
        for i in range(right, left, -1):
            if a[i - 1] > a[i]:
                t = a[i]
                a[i] = a[i - 1]
                a[i - 1] = t
                last = i
        left = last


@kernel
def unsharp_row(src: u8[:], dst: u8[:], n: i32, gain: i32) -> None:
    for x in range(2, n - 2):
        smooth = (src[x - 2] + 4 * src[x - 1] + 6 * src[x] + 4 * src[x + 1] + src[x + 2]) >> 4
        v = src[x] + (((src[x] - smooth) * gain) >> 4)
        if v < 0:
            v = 0
        elif v > 255:
            v = 255
        dst[x] = v


@kernel
def wall_follow(grey: u8[:], mark: u8[:], w: i32, h: i32, start: i32, tolerance: i32, stack: u16[:]) -> i32:
    level = grey[start]
    top = 1
    total = 0
    stack[0] = start
    mark[start] = 1
    while top > 0:
        top = top - 1
        p = stack[top]
        total = total + grey[p]
        if p >= w and mark[p - w] == 0 and grey[p - w] <= level + tolerance:
            mark[p - w] = 1
            stack[top] = p - w
            top = top + 1
        if p < w * (h - 1) and mark[p + w] == 0 and grey[p + w] <= level + tolerance:
            mark[p + w] = 1
            stack[top] = p + w
            top = top + 1
        if p > 0 and mark[p - 1] == 0 and grey[p - 1] <= level + tolerance:
            mark[p - 1] = 1
            stack[top] = p - 1
            top = top + 1
        if p < w * h - 1 and mark[p + 1] == 0 and grey[p + 1] <= level + tolerance:
            mark[p + 1] = 1
            stack[top] = p + 1
            top = top + 1
    return total


@kernel
def hsv_class(r: u8[:], g: u8[:], b: u8[:], table: u8[:], out: u8[:], n: i32) -> None:
    for i in range(n):
        most = r[i]
        least = r[i]
        if g[i] > most:
            most = g[i]
        if b[i] > most:
            most = b[i]
        if g[i] < least:
            least = g[i]
        if b[i] < least:
            least = b[i]
        if most - least < 32:
            out[i] = 0
        else:
            out[i] = table[((most >> 4) << 4) | (least >> 4)]


@kernel
def bit_matrix(rows: u32[:], columns: u32[:], bits: u8[:]) -> None:
    for i in range(32):
        word: u32 = 0
        count = 0
        for j in range(32):
            bit = (rows[j] >> i) & 1
            word |= bit << j
            if ((rows[i] >> j) & 1) != 0:
                count += 1
        columns[i] = word
        bits[i] = count


def play_cocktail(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = lcg.bytes(60)
    run(a, 60)
    return (a,)


def play_unsharp(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(240, np.uint8)
    run(lcg.bytes(240), dst, 240, 20)
    return (dst,)


def play_level(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    grey, mark = lcg.bytes(600), np.zeros(600, np.uint8)
    grey[300] = 100
    total = run(grey, mark, 30, 20, 300, 80, np.zeros(600, np.uint16))
    return mark, word(total)


def play_class(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(300, np.uint8)
    run(lcg.bytes(300), lcg.bytes(300), lcg.bytes(300), lcg.bytes(256), out, 300)
    return (out,)


def play_bits(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    rows = np.array([lcg.next() for _ in range(32)], np.uint32)
    columns, bits = np.zeros(32, np.uint32), np.zeros(32, np.uint8)
    run(rows, columns, bits)
    return columns, bits


CASES = (
    Case(cocktail_sort, 1501, play_cocktail),
    Case(unsharp_row, 1502, play_unsharp),
    Case(wall_follow, 1503, play_level),
    Case(hsv_class, 1504, play_class),
    Case(bit_matrix, 1505, play_bits),
)
