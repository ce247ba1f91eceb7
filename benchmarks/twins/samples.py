"""Samples, angles and points in fixed point: filters, a sine, an arctangent, a matrix."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.angles import ATAN257
from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def iir_lowpass(samples: i16[:], out: i16[:], n: i32, gain: i32, limit: i32) -> i32:
    state = 0
    clipped = 0
    for i in range(n):
        state += ((samples[i] * 16 - state) * (gain >> 8)) >> 8
        y = state >> 4
        if y > limit:
            y = limit
            clipped += 1
        elif y < -limit:
            y = -limit
            clipped += 1
        out[i] = y
    return clipped


@kernel
def goertzel(samples: i16[:], n: i32, coefficient: i16[:], power: i32[:], m: i32) -> None:
    for k in range(m):
        c = coefficient[k]
        s1 = 0
        s2 = 0
        for i in range(n):
            s0 = samples[i] + ((c * s1) >> 14) - s2
            s2 = s1
            s1 = s0
        cross = (c * s1) >> 14
        power[k] = s1 * s1 + s2 * s2 - cross * s2


@kernel
def resonators(samples: i16[:], n: i32, a1: i16[:], a2: i16[:], out: i32[:], m: i32) -> None:
    for k in range(m):
        y1 = 0
        y2 = 0
        total = 0
        for i in range(n):
            y = samples[i] + ((a1[k] * y1 - a2[k] * y2) >> 12)
            total += -y if y < 0 else y
            y2 = y1
            y1 = y
        out[k] = total


@kernel
def moving_sum(src: i16[:], dst: i32[:], w: i32, h: i32, size: i32) -> None:
    for y in range(h):
        total = 0
        for x in range(w):
            total += src[y * w + x]
            if x >= size:
                total -= src[y * w + x - size]
            dst[y * w + x] = total


@kernel
def sine_lerp(angle: u16[:], quarter: i16[:], out: i16[:], n: i32) -> None:
    for i in range(n):
        a = angle[i]
        phase = a & 0x3FFF
        if (a & 0x4000) != 0:
            phase = 0x4000 - phase
        k = phase >> 8
        y = quarter[k]
        if k < 64:
            y += ((quarter[k + 1] - y) * (phase & 255)) >> 8
        out[i] = -y if (a & 0x8000) != 0 else y


@kernel
def atan2_table(dx: i16[:], dy: i16[:], table: u8[:], out: u8[:], n: i32) -> None:
    for i in range(n):
        x = dx[i]
        y = dy[i]
        ax = u32(-x if x < 0 else x)
        ay = u32(-y if y < 0 else y)
        angle = 0
        if ax >= ay:
            if ax > 0:
                angle = table[(ay << 8) // ax]
        else:
            angle = 64 - table[(ax << 8) // ay]
        if x < 0:
            angle = 128 - angle
        if y < 0:
            angle = -angle
        out[i] = angle & 255


@kernel
def affine_points(x: i16[:], y: i16[:], m: i16[:], n: i32, u: i16[:], v: i16[:], w: i32, h: i32) -> i32:
    kept = 0
    for i in range(n):
        px = (m[0] * x[i] + m[1] * y[i] + m[2] * 256) >> 8
        py = (m[3] * x[i] + m[4] * y[i] + m[5] * 256) >> 8
        if px >= 0 and px < w and py >= 0 and py < h:
            u[kept] = px
            v[kept] = py
            kept += 1
    return kept


def play_iir(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples = np.array([lcg.u16() - 32768 for _ in range(500)], np.int16)
    out = np.zeros(500, np.int16)
    clipped = run(samples, out, 500, 5243, 9000)
    return out, word(clipped)


def play_goertzel(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples, coefficient = lcg.scaled(64, 200, -100), lcg.scaled(8, 60000, -30000)
    power = np.zeros(8, np.int32)
    run(samples, 64, coefficient, power, 8)
    return (power,)


def play_resonators(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples, a1, a2 = lcg.scaled(60, 2000, -1000), lcg.scaled(6, 6000, -3000), lcg.scaled(6, 3000)
    out = np.zeros(6, np.int32)
    run(samples, 60, a1, a2, out, 6)
    return (out,)


def play_moving(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(600, np.int32)
    run(lcg.scaled(600, 2000, -1000), dst, 60, 10, 7)
    return (dst,)


def play_sine(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    angle = np.array([lcg.u16() for _ in range(500)], np.uint16)
    out = np.zeros(500, np.int16)
    run(angle, np.array([i * (760 - 4 * i) for i in range(65)], np.int16), out, 500)
    return (out,)


def play_atan(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dx, dy = lcg.scaled(200, 2001, -1000), lcg.scaled(200, 2001, -1000)
    out = np.zeros(200, np.uint8)
    run(dx, dy, ATAN257, out, 200)
    return (out,)


def play_affine(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    x, y = lcg.scaled(200, 320), lcg.scaled(200, 240)
    u, v = np.zeros(200, np.int16), np.zeros(200, np.int16)
    m = np.array([230, -110, 40, 110, 230, -60], np.int16)
    kept = run(x, y, m, 200, u, v, 320, 240)
    return u, v, word(kept)


CASES = (
    Case(iir_lowpass, 1204, play_iir),
    Case(goertzel, 1224, play_goertzel),
    Case(resonators, 1241, play_resonators),
    Case(moving_sum, 1246, play_moving),
    Case(sine_lerp, 1208, play_sine),
    Case(atan2_table, 1229, play_atan),
    Case(affine_points, 1223, play_affine),
)
