"""Neighbourhoods: the game of life, halved images, dithering, medians of windows, products of matrices."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8


@kernel
def life_step(src: u8[:], dst: u8[:], w: i32, h: i32) -> i32:
    alive = 0
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            p = y * w + x
            n = (
                src[p - w - 1]
                + src[p - w]
                + src[p - w + 1]
                + src[p - 1]
                + src[p + 1]
                + src[p + w - 1]
                + src[p + w]
                + src[p + w + 1]
            )
            if n == 3 or (n == 2 and src[p] != 0):
                dst[p] = 1
                alive += 1
            else:
                dst[p] = 0
    return alive


@kernel
def halve_image(src: u8[:], w: i32, h: i32, dst: u8[:]) -> None:
    for y in range(h):
        for x in range(w):
            total = 2
            for dy in range(2):
                for dx in range(2):
                    total += src[(2 * y + dy) * 2 * w + 2 * x + dx]
            dst[y * w + x] = total >> 2


@kernel
def dither_rows(grey: i16[:], w: i32, h: i32, out: u8[:]) -> None:
    for y in range(h - 1):
        for x in range(1, w - 1):
            p = y * w + x
            v = grey[p]
            e = v
            out[p] = 0
            if v > 127:
                out[p] = 255
                e = v - 255
            grey[p + 1] = grey[p + 1] + ((e * 7) >> 4)
            grey[p + w - 1] = grey[p + w - 1] + ((e * 3) >> 4)
            grey[p + w] = grey[p + w] + ((e * 5) >> 4)
            grey[p + w + 1] = grey[p + w + 1] + (e >> 4)


@kernel
def matmul_q8(a: i32[:], b: i32[:], c: i32[:], n: i32) -> None:
    for i in range(n):
        for j in range(n):
            total = 0
            for k in range(n):
                total += (a[i * n + k] * b[k * n + j]) >> 8
            c[i * n + j] = total


@kernel
def median_window(x: i16[:], n: i32, k: i32, window: i16[:], out: i16[:]) -> None:
    for i in range(n - k + 1):
        for j in range(k):
            v = x[i + j]
            m = j - 1
            while m >= 0 and window[m] > v:
                window[m + 1] = window[m]
                m -= 1
            window[m + 1] = v
        out[i] = window[k >> 1]


def play_life(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    src, dst = np.array([lcg.u8() < 90 for _ in range(24 * 20)], np.uint8), np.zeros(24 * 20, np.uint8)
    alive = run(src, dst, 24, 20)
    return dst, word(alive)


def play_halve(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(20 * 14, np.uint8)
    run(lcg.bytes(4 * 20 * 14), 20, 14, dst)
    return (dst,)


def play_dither(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(32 * 12, np.uint8)
    run(lcg.bytes(32 * 12).astype(np.int16), 32, 12, out)
    return (out,)


def play_matmul(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    c = np.zeros(81, np.int32)
    run(lcg.scaled(81, 2048, -1024, "i4"), lcg.scaled(81, 2048, -1024, "i4"), c, 9)
    return (c,)


def play_median(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    x = np.array([lcg.u16() - 32768 for _ in range(150)], np.int16)
    out = np.zeros(150, np.int16)
    run(x, 150, 5, np.zeros(5, np.int16), out)
    return (out,)


CASES = (
    Case(life_step, 1402, play_life),
    Case(halve_image, 1403, play_halve),
    Case(dither_rows, 1406, play_dither),
    Case(matmul_q8, 1407, play_matmul),
    Case(median_window, 1408, play_median),
)
