"""Patches of an image: half size, block matching, extremes, moments."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def downsample2(src: u8[:], dst: u8[:], w: i32, h: i32) -> None:
    k = 0
    for y in range(0, h, 2):
        for x in range(0, w, 2):
            p = y * w + x
            dst[k] = (src[p] + src[p + 1] + src[p + w] + src[p + w + 1] + 2) >> 2
            k += 1


@kernel
def sad_search(left: u8[:], right: u8[:], blocks: i32, reach: i32, shift: u8[:], score: u16[:]) -> None:
    for b in range(blocks):
        x = reach + b * 8
        best = 65535
        best_d = 0
        for d in range(reach):
            sad = 0
            for k in range(8):
                diff = left[x + k] - right[x - d + k]
                if diff < 0:
                    diff = -diff
                sad += diff
            if sad < best:
                best = sad
                best_d = d
        shift[b] = best_d
        score[b] = best


@kernel
def extremes(a: i16[:], n: i32, out: i32[:]) -> None:
    low = 32767
    high = -32768
    low_at = 0
    high_at = 0
    for i in range(n):
        v = a[i]
        if v < low:
            low = v
            low_at = i
        if v > high:
            high = v
            high_at = i
    out[0] = low
    out[1] = high
    out[2] = low_at
    out[3] = high_at


@kernel
def moments(patch: u8[:], w: i32, h: i32, out: i32[:]) -> None:
    m00 = 0
    m10 = 0
    m01 = 0
    m11 = 0
    m20 = 0
    m02 = 0
    m30 = 0
    m21 = 0
    m12 = 0
    m03 = 0
    dark = 255
    bright = 0
    p = 0
    for y in range(h):
        for x in range(w):
            v = patch[p]
            xv = x * v
            yv = y * v
            m00 += v
            m10 += xv
            m01 += yv
            m11 += x * yv
            m20 += x * xv
            m02 += y * yv
            m30 += x * x * xv
            m21 += x * x * yv
            m12 += y * y * xv
            m03 += y * y * yv
            dark = v if v < dark else dark
            bright = v if v > bright else bright
            p += 1
    out[0] = m00
    out[1] = m10
    out[2] = m01
    out[3] = m11
    out[4] = m20
    out[5] = m02
    out[6] = m30
    out[7] = m21
    out[8] = m12
    out[9] = m03
    out[10] = dark
    out[11] = bright


def play_downsample(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(768, np.uint8)
    run(lcg.bytes(64 * 48), dst, 64, 48)
    return (dst,)


def play_sad(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    shift, score = np.zeros(14, np.uint8), np.zeros(14, np.uint16)
    run(lcg.bytes(128), lcg.bytes(128), 14, 16, shift, score)
    return shift, score


def play_extremes(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(4, np.int32)
    run(np.array([lcg.u16() - 32768 for _ in range(1000)], np.int16), 1000, out)
    return (out,)


def play_moments(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(12, np.int32)
    run(lcg.bytes(24 * 20), 24, 20, out)
    return (out,)


CASES = (
    Case(downsample2, 1129, play_downsample),
    Case(sad_search, 1131, play_sad),
    Case(extremes, 1133, play_extremes),
    Case(moments, 1149, play_moments),
)
