"""Rows of pixels: luminance, smoothing, gradients, thinning, morphology, look-up and copying."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u32


@kernel
def gray_from_uyvy_row(uyvy: u8[:], y: u8[:], n: i32):
    for i in range(n):
        y[i] = uyvy[2 * i + 1]


@kernel
def gauss3_row(r0: u8[:], r1: u8[:], r2: u8[:], out: u8[:], w: i32):
    out[0] = r1[0]
    for x in range(1, w - 1):
        a = r0[x - 1] + 2 * r0[x] + r0[x + 1]
        b = r1[x - 1] + 2 * r1[x] + r1[x + 1]
        c = r2[x - 1] + 2 * r2[x] + r2[x + 1]
        out[x] = (a + 2 * b + c) >> 4
    out[w - 1] = r1[w - 1]


@kernel
def sobel_row(r0: u8[:], r1: u8[:], r2: u8[:], gx: i16[:], gy: i16[:], w: i32):
    gx[0] = 0
    gy[0] = 0
    for x in range(1, w - 1):
        left = r0[x - 1] + 2 * r1[x - 1] + r2[x - 1]
        right = r0[x + 1] + 2 * r1[x + 1] + r2[x + 1]
        top = r0[x - 1] + 2 * r0[x] + r0[x + 1]
        bottom = r2[x - 1] + 2 * r2[x] + r2[x + 1]
        gx[x] = right - left
        gy[x] = bottom - top
    gx[w - 1] = 0
    gy[w - 1] = 0


@kernel
def mag_abs_row(gx: i16[:], gy: i16[:], mag: u8[:], n: i32):
    for i in range(n):
        a = gx[i]
        b = gy[i]
        if a < 0:
            a = -a
        if b < 0:
            b = -b
        m = a + b
        if m > 255:
            m = 255
        mag[i] = m


@kernel
def nms_row(m0: u8[:], m1: u8[:], m2: u8[:], direction: u8[:], out: u8[:], w: i32):
    out[0] = 0
    for x in range(1, w - 1):
        m = m1[x]
        sector = ((direction[x] + 16) >> 5) & 3
        if sector == 0:
            a = m1[x - 1]
            b = m1[x + 1]
        elif sector == 1:
            a = m0[x - 1]
            b = m2[x + 1]
        elif sector == 2:
            a = m0[x]
            b = m2[x]
        else:
            a = m0[x + 1]
            b = m2[x - 1]
        if m >= a and m > b:
            out[x] = m
        else:
            out[x] = 0
    out[w - 1] = 0


@kernel
def erode32_row(r0: u32[:], r1: u32[:], r2: u32[:], out: u32[:], w: i32):
    out[0] = 0
    for x in range(1, w - 1):
        a = r0[x - 1] & r0[x] & r0[x + 1]
        b = r1[x - 1] & r1[x] & r1[x + 1]
        c = r2[x - 1] & r2[x] & r2[x + 1]
        out[x] = a & b & c
    out[w - 1] = 0


@kernel
def dilate32_row(r0: u32[:], r1: u32[:], r2: u32[:], out: u32[:], w: i32):
    out[0] = 0
    for x in range(1, w - 1):
        a = r0[x - 1] | r0[x] | r0[x + 1]
        b = r1[x - 1] | r1[x] | r1[x + 1]
        c = r2[x - 1] | r2[x] | r2[x + 1]
        out[x] = a | b | c
    out[w - 1] = 0


@kernel
def remap_row(src: u8[:], lut: u32[:], dst: u8[:], n: i32):
    for x in range(n):
        dst[x] = src[lut[x]]


@kernel
def copy_words(src: u32[:], dst: u32[:], n: i32):
    for i in range(n):
        dst[i] = src[i]


def play_gray(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    y = np.zeros(320, np.uint8)
    run(lcg.bytes(640), y, 320)
    return (y,)


def play_gauss(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(320, np.uint8)
    run(lcg.bytes(320), lcg.bytes(320), lcg.bytes(320), out, 320)
    return (out,)


def play_sobel(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    gx, gy = np.zeros(320, np.int16), np.zeros(320, np.int16)
    run(lcg.bytes(320), lcg.bytes(320), lcg.bytes(320), gx, gy, 320)
    return gx, gy


def play_mag(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(320, np.uint8)
    run(lcg.scaled(320, 511, -255), lcg.scaled(320, 511, -255), out, 320)
    return (out,)


def play_nms(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(320, np.uint8)
    run(*(lcg.bytes(320) for _ in range(4)), out, 320)
    return (out,)


def play_erode(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    rows = [np.array([lcg.next() | lcg.next() | lcg.next() for _ in range(320)], np.uint32) for _ in range(3)]
    out = np.zeros(320, np.uint32)
    run(*rows, out, 320)
    return (out,)


def play_dilate(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    rows = [np.array([lcg.next() & lcg.next() & lcg.next() for _ in range(320)], np.uint32) for _ in range(3)]
    out = np.zeros(320, np.uint32)
    run(*rows, out, 320)
    return (out,)


def play_remap(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(320, np.uint8)
    run(lcg.bytes(20480), lcg.scaled(320, 20480, kind="u4"), out, 320)
    return (out,)


def play_copy(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(4096, np.uint32)
    run(np.array([lcg.next() for _ in range(4096)], np.uint32), out, 4096)
    return (out,)


CASES = (
    Case(gray_from_uyvy_row, 1001, play_gray),
    Case(gauss3_row, 1002, play_gauss),
    Case(sobel_row, 1003, play_sobel),
    Case(mag_abs_row, 1005, play_mag),
    Case(nms_row, 1007, play_nms),
    Case(erode32_row, 1009, play_erode),
    Case(dilate32_row, 1010, play_dilate),
    Case(remap_row, 1013, play_remap),
    Case(copy_words, 1018, play_copy),
)
