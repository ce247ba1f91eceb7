"""Signals: matrix times vector, biquad, separable smoothing, integral image, cubic interpolation."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u32


@kernel
def matvec(m: i32[:], v: i32[:], out: i32[:], rows: i32, cols: i32) -> None:
    k = 0
    for r in range(rows):
        total = 0
        for c in range(cols):
            total += m[k] * v[c]
            k += 1
        out[r] = total >> 8


@kernel
def biquad(x0: i16[:], out: i16[:], n: i32, b0: i32, b1: i32, b2: i32, a1: i32, a2: i32) -> None:
    x1 = 0
    x2 = 0
    y1 = 0
    y2 = 0
    for i in range(n):
        x = x0[i]
        y = (b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2 + 8192) >> 14
        if y > 32767:
            y = 32767
        elif y < -32768:
            y = -32768
        x2 = x1
        x1 = x
        y2 = y1
        y1 = y
        out[i] = y


@kernel
def separable5(src: u8[:], tmp: i16[:], dst: u8[:], w: i32, h: i32) -> None:
    for y in range(h):
        for x in range(2, w - 2):
            p = y * w + x
            tmp[p] = src[p - 2] + 4 * src[p - 1] + 6 * src[p] + 4 * src[p + 1] + src[p + 2]
    for y in range(2, h - 2):
        for x in range(2, w - 2):
            p = y * w + x
            total = tmp[p - 2 * w] + tmp[p + 2 * w]
            total += 4 * (tmp[p - w] + tmp[p + w])
            total += 6 * tmp[p]
            dst[p] = (total + 128) >> 8


@kernel
def integral_image(src: u8[:], out: u32[:], w: i32, h: i32) -> None:
    stride = w + 1
    for x in range(stride):
        out[x] = 0
    for y in range(h):
        row: u32 = 0
        to = (y + 1) * stride
        out[to] = 0
        for x in range(w):
            row += u32(src[y * w + x])
            out[to + x + 1] = out[to + x + 1 - stride] + row


@kernel
def cubic(a: i32, b: i32, c: i32, d: i32, t: i32) -> i32:
    c1 = c - a
    c2 = 2 * a - 5 * b + 4 * c - d
    c3 = 3 * (b - c) + d - a
    v = ((c3 * t) >> 8) + c2
    v = ((v * t) >> 8) + c1
    v = ((v * t) >> 9) + b
    return max(0, min(v, 255))


@kernel
def cubic_row(src: u8[:], dst: u8[:], n: i32, step: i32) -> None:
    pos = 256
    for i in range(n):
        x = pos >> 8
        dst[i] = cubic(src[x - 1], src[x], src[x + 1], src[x + 2], pos & 255)
        pos += step


def play_matvec(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(30, np.int32)
    run(lcg.scaled(720, 2000, -1000, "i4"), lcg.scaled(24, 60000, -30000, "i4"), out, 30, 24)
    return (out,)


def play_biquad(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(400, np.int16)
    x = np.array([lcg.u16() - 32768 for _ in range(400)], np.int16)
    run(x, out, 400, 6000, 4000, 3000, -20000, 8000)
    return (out,)


def play_separable(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    tmp, dst = np.zeros(640, np.int16), np.zeros(640, np.uint8)
    run(lcg.bytes(640), tmp, dst, 32, 20)
    return dst, tmp


def play_integral(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(33 * 25, np.uint32)
    run(lcg.bytes(32 * 24), out, 32, 24)
    return (out,)


def play_cubic(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(200, np.uint8)
    run(lcg.bytes(128), dst, 200, 150)
    return (dst,)


CASES = (
    Case(matvec, 1120, play_matvec),
    Case(biquad, 1122, play_biquad),
    Case(separable5, 1124, play_separable),
    Case(integral_image, 1126, play_integral),
    Case(cubic_row, 1150, play_cubic),
)
