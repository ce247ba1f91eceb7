"""Fixed point: a root by bits, a rotation by CORDIC, a filter with saturation, a reciprocal, a dot product with norms."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u16, u32


@kernel
def root_by_bits(value: u32) -> u32:
    result: u32 = 0
    bit: u32 = 1 << 30
    while bit > value:
        bit >>= 2
    while bit != 0:
        if value >= result + bit:
            value -= result + bit
            result = (result >> 1) + bit
        else:
            result >>= 1
        bit >>= 2
    return result


@kernel
def distances(x: i16[:], y: i16[:], n: i32, out: u16[:]) -> None:
    for i in range(n - 1):
        dx = x[i + 1] - x[i]
        dy = y[i + 1] - y[i]
        out[i] = root_by_bits(u32(dx * dx + dy * dy))


@kernel
def rotate_points(x: i32[:], y: i32[:], n: i32, angle: i32, steps: i32[:], iterations: i32) -> None:
    for p in range(n):
        px = x[p]
        py = y[p]
        left = angle
        for i in range(iterations):
            if left >= 0:
                moved = px - (py >> i)
                py = py + (px >> i)
                px = moved
                left -= steps[i]
            else:
                moved = px + (py >> i)
                py = py - (px >> i)
                px = moved
                left += steps[i]
        x[p] = px
        y[p] = py


@kernel
def saturated(value: i32) -> i32:
    if value > 32767:
        return 32767
    if value < -32768:
        return -32768
    return value


@kernel
def fir_q15(samples: i16[:], taps: i16[:], out: i16[:], n: i32, length: i32) -> None:
    for i in range(n):
        total = 1 << 14
        for k in range(length):
            total += samples[i + k] * taps[k]
        out[i] = saturated(total >> 15)


@kernel
def reciprocals(values: u16[:], out: u32[:], n: i32) -> None:
    for i in range(n):
        v = u32(values[i])
        shift: u32 = 0
        while v < 0x8000:
            v <<= 1
            shift += 1
        guess = 0x17504 - v
        for _ in range(2):
            product = (v * (guess >> 1)) >> 14
            guess = ((guess >> 1) * ((0x20000 - product) >> 1)) >> 14
        out[i] = guess << shift


@kernel
def correlate(a: i16[:], b: i16[:], n: i32, lags: i32, found: i32[:]) -> i32:
    best = 0
    for lag in range(lags):
        total = 0
        for i in range(n - lag):
            total += (a[i] * b[i + lag]) >> 8
        found[lag] = total
        if total > found[best]:
            best = lag
    return best


def play_distances(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    x, y = (lcg.scaled(61, 2000, -1000) for _ in range(2))
    out = np.zeros(60, np.uint16)
    run(x, y, 61, out)
    return (out,)


def play_rotation(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    x, y = (lcg.scaled(50, 20000, -10000, "i4") for _ in range(2))
    steps = np.round(np.arctan(0.5 ** np.arange(12)) * 4096).astype(np.int32)
    run(x, y, 50, 2345, steps, 12)
    return x, y


def play_fir(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples, taps = lcg.scaled(180, 60000, -30000), lcg.scaled(12, 30000, -8000)
    out = np.zeros(160, np.int16)
    run(samples, taps, out, 160, 12)
    return (out,)


def play_reciprocals(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    values = np.array([1 + (lcg.u16() >> lcg.below(12)) % 60000 for _ in range(120)], np.uint16)
    out = np.zeros(120, np.uint32)
    run(values, out, 120)
    return (out,)


def play_correlation(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = lcg.scaled(100, 2000, -1000)
    found = np.zeros(20, np.int32)
    best = run(a, np.roll(a, 7), 100, 20, found)
    return found, word(best)


CASES = (
    Case(distances, 2231, play_distances, exported=True),
    Case(rotate_points, 2232, play_rotation, exported=True),
    Case(fir_q15, 2233, play_fir, exported=True),
    Case(reciprocals, 2234, play_reciprocals, exported=True),
    Case(correlate, 2235, play_correlation, exported=True),
)
