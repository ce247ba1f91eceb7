"""Sums of products and running sums: matrix product, FIR, 3 x 3 convolution, box filter."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8


@kernel
def matmul_i16(a: i16[:], b: i16[:], c: i32[:], n: i32) -> None:
    for i in range(n):
        for j in range(n):
            total = 0
            for k in range(n):
                total += a[i * n + k] * b[k * n + j]
            c[i * n + j] = total


@kernel
def fir_i16(x: i16[:], coef: i16[:], y: i16[:], n: i32, taps: i32) -> None:
    for i in range(n):
        total = 1 << 14
        for k in range(taps):
            total += x[i + k] * coef[k]
        y[i] = total >> 15


@kernel
def conv3x3(src: u8[:], coef: i16[:], dst: u8[:], w: i32, h: i32, shift: i32) -> None:
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            total = 0
            for ky in range(3):
                for kx in range(3):
                    total += coef[ky * 3 + kx] * src[(y + ky - 1) * w + x + kx - 1]
            total = total >> shift
            if total < 0:
                total = 0
            if total > 255:
                total = 255
            dst[y * w + x] = total


@kernel
def box_running(src: u8[:], dst: u8[:], n: i32, radius: i32, scale: i32) -> None:
    total = 0
    for i in range(2 * radius + 1):
        total += src[i]
    last = n - radius - 1
    for i in range(radius, last):
        dst[i] = (total * scale) >> 16
        total = total + src[i + radius + 1] - src[i - radius]
    dst[last] = (total * scale) >> 16


def play_matmul(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    c = np.zeros(256, np.int32)
    run(lcg.scaled(256, 4000, -2000), lcg.scaled(256, 4000, -2000), c, 16)
    return (c,)


def play_fir(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    x = np.array([lcg.u16() - 32768 for _ in range(144)], np.int16)
    y = np.zeros(128, np.int16)
    run(x, lcg.scaled(16, 4000, -2000), y, 128, 16)
    return (y,)


def play_conv(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    coef = np.array([-1, -2, -1, -2, 28, -2, -1, -2, -1], np.int16)
    dst = np.zeros(24 * 20, np.uint8)
    run(lcg.bytes(24 * 20), coef, dst, 24, 20, 4)
    return (dst,)


def play_box(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(1024, np.uint8)
    run(lcg.bytes(1024), dst, 1024, 4, 7282)
    return (dst,)


CASES = (
    Case(matmul_i16, 1121, play_matmul),
    Case(fir_i16, 1123, play_fir),
    Case(conv3x3, 1125, play_conv),
    Case(box_running, 1127, play_box),
)
