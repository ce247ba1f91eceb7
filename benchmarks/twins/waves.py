"""Sampled signals: a symmetric filter, a blocker of direct current, rates of crossings, likeness of a signal to itself, a limited slope."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8


@kernel
def symmetric_filter(x: i16[:], n: i32, taps: i16[:], half: i32, out: i16[:]) -> None:
    for i in range(half, n - half):
        total = x[i] * taps[0] + (1 << 14)
        for k in range(1, half + 1):
            total += (x[i - k] + x[i + k]) * taps[k]
        out[i - half] = total >> 15


@kernel
def block_direct(x: i16[:], n: i32, out: i16[:]) -> i32:
    before = 0
    held = 0
    clipped = 0
    for i in range(n):
        here = x[i]
        held += ((here - before) << 8) - (held >> 5)
        before = here
        value = held >> 8
        if value > 32767:
            value = 32767
            clipped += 1
        elif value < -32768:
            value = -32768
            clipped += 1
        out[i] = value
    return clipped


@kernel
def crossing_rates(x: i16[:], n: i32, window: i32, rates: u8[:]) -> i32:
    place = 0
    at = 0
    while at + window <= n:
        crossed = 0
        positive = 1 if x[at] >= 0 else 0
        for i in range(at + 1, at + window):
            now = 1 if x[i] >= 0 else 0
            if now != positive:
                crossed += 1
                positive = now
        rates[place] = min(crossed, 255)
        place += 1
        at += window
    return place


@kernel
def likeness(x: i16[:], n: i32, lags: i32, out: i32[:]) -> i32:
    best = 1
    for lag in range(lags):
        total = 0
        for i in range(n - lag):
            total += (x[i] * x[i + lag]) >> 8
        out[lag] = total
        if lag > 1 and total > out[best]:
            best = lag
    return best


@kernel
def limit_slope(target: i16[:], n: i32, up: i32, down: i32, out: i16[:]) -> i32:
    here = 0
    late = 0
    for i in range(n):
        wanted = target[i]
        if wanted > here + up:
            here += up
            late += 1
        elif wanted < here - down:
            here -= down
            late += 1
        else:
            here = wanted
        out[i] = here
    return late


def play_symmetric(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(120, np.int16)
    run(lcg.scaled(120, 20001, -10000), 120, lcg.scaled(6, 5000, -500), 5, out)
    return (out,)


def play_block(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(300, np.int16)
    clipped = run(lcg.scaled(300, 65001, -32500), 300, out)
    return out, word(clipped)


def play_rates(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    rates = np.zeros(40, np.uint8)
    windows = run(lcg.scaled(500, 2001, -1000), 500, 32, rates)
    return rates, word(windows)


def play_likeness(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(16, np.int32)
    best = run(lcg.scaled(100, 4001, -2000), 100, 16, out)
    return out, word(best)


def play_slope(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(400, np.int16)
    late = run(np.repeat(lcg.scaled(40, 2001, -1000), 10), 400, 60, 90, out)
    return out, word(late)


CASES = (
    Case(symmetric_filter, 2721, play_symmetric, exported=True),
    Case(block_direct, 2722, play_block, exported=True),
    Case(crossing_rates, 2723, play_rates, exported=True),
    Case(likeness, 2724, play_likeness, exported=True),
    Case(limit_slope, 2725, play_slope, exported=True),
)
