"""Transforms of blocks and images: cosines, matrices, decimation, erosion, scaling."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8


@kernel
def dct8x8(pixels: u8[:], cosines: i16[:], rows: i16[:], out: i16[:], blocks: i32) -> None:
    for b in range(blocks):
        for y in range(8):
            for u in range(8):
                total = 0
                for x in range(8):
                    total += (pixels[b * 64 + y * 8 + x] - 128) * cosines[u * 8 + x]
                rows[y * 8 + u] = (total + 2048) >> 12
        for u in range(8):
            for v in range(8):
                total = 0
                for y in range(8):
                    total += rows[y * 8 + u] * cosines[v * 8 + y]
                out[b * 64 + v * 8 + u] = (total + 2048) >> 12


@kernel
def mat4_points(points: i16[:], n: i32, matrix: i16[:], out: i16[:], half: i32) -> i32:
    inside = 0
    for i in range(n):
        ok = 1
        for r in range(3):
            total = matrix[4 * r + 3] << 12
            for c in range(3):
                total += matrix[4 * r + c] * points[3 * i + c]
            total = total >> 12
            if total > half or total < -half:
                ok = 0
            out[3 * i + r] = total
        inside += ok
    return inside


@kernel
def fir_decimate(x: i16[:], n: i32, taps: i16[:], k: i32, y: i16[:]) -> None:
    o = 0
    for i in range(k - 1, n, 2):
        total = 1 << 13
        for t in range(k):
            total += x[i - t] * taps[t]
        total = total >> 14
        if total > 32767:
            total = 32767
        if total < -32768:
            total = -32768
        y[o] = total
        o += 1  # noqa: SIM113 - as in C


@kernel
def erode3x3(src: u8[:], w: i32, h: i32, dst: u8[:]) -> None:
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            least = 255
            for dy in range(-1, 2):
                for dx in range(-1, 2):
                    v = src[(y + dy) * w + x + dx]
                    if v < least:
                        least = v
            dst[y * w + x] = least


@kernel
def scale_bilinear(src: u8[:], w: i32, sx: i32, sy: i32, dst: u8[:], ow: i32, oh: i32) -> None:
    for y in range(oh):
        v = y * sy
        fy = v & 255
        row = (v >> 8) * w
        for x in range(ow):
            u = x * sx
            fx = u & 255
            p = row + (u >> 8)
            top = (src[p] << 8) + (src[p + 1] - src[p]) * fx
            bottom = (src[p + w] << 8) + (src[p + w + 1] - src[p + w]) * fx
            dst[y * ow + x] = (top * (256 - fy) + bottom * fy) >> 16


def play_dct(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(128, np.int16)
    run(lcg.bytes(128), lcg.scaled(64, 4096, -2048), np.zeros(64, np.int16), out, 2)
    return (out,)


def play_points(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(360, np.int16)
    inside = run(lcg.scaled(360, 4000, -2000), 120, lcg.scaled(12, 8192, -4096), out, 1500)
    return out, word(inside)


def play_fir(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    x, y = np.array([lcg.u16() - 32768 for _ in range(256)], np.int16), np.zeros(256, np.int16)
    run(x, 256, lcg.scaled(12, 8192, -4096), 12, y)
    return (y,)


def play_erode(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(32 * 20, np.uint8)
    run(lcg.bytes(32 * 20), 32, 20, dst)
    return (dst,)


def play_scale(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(32 * 20, np.uint8)
    run(lcg.bytes(24 * 18), 24, 23 * 256 // 32, 17 * 256 // 20, dst, 32, 20)
    return (dst,)


CASES = (
    Case(dct8x8, 1306, play_dct),
    Case(mat4_points, 1307, play_points),
    Case(fir_decimate, 1308, play_fir),
    Case(erode3x3, 1309, play_erode),
    Case(scale_bilinear, 1310, play_scale),
)
