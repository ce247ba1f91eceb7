"""Measurements: spikes, a tank, headings, differences as bytes, an echo, the places of bits."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i8, i16, i32, kernel, u8, u16, u32


@kernel
def median3(a: i32, b: i32, c: i32) -> i32:
    low = min(a, b)
    high = max(a, b)
    return max(low, min(high, c))


@kernel
def despike(samples: i16[:], n: i32, most: i32) -> i32:
    changed = 0
    for i in range(1, n - 1):
        m = median3(samples[i - 1], samples[i], samples[i + 1])
        if abs(samples[i] - m) > most:
            samples[i] = m
            changed += 1
    return changed


@kernel
def tank_controller(levels: u16[:], n: i32, low: i32, high: i32, valve: u8[:]) -> i32:
    state = 0
    timer = 0
    switched = 0
    for t in range(n):
        level = i32(levels[t])
        if state == 0:
            if level < low:
                state = 1
                timer = 5
                switched += 1
        elif state == 1:
            if timer > 0:
                timer -= 1
            elif level > high:
                state = 2
                timer = 8
                switched += 1
        else:
            timer -= 1
            if timer <= 0:
                state = 0
        valve[t] = 1 if state == 1 else 0
    return switched


@kernel
def smooth_heading(angles: u8[:], n: i32, weight: i32, out: u8[:]) -> None:
    """Angles in 256ths of a turn, smoothed the short way round."""
    held = i32(angles[0]) << 8
    for i in range(n):
        off = (i32(angles[i]) << 8) - held
        off = ((off + 32768) & 0xFFFF) - 32768
        held = (held + ((off * weight) >> 8)) & 0xFFFF
        out[i] = held >> 8


@kernel
def pack_deltas(values: i16[:], n: i32, out: i8[:]) -> i32:
    """Differences that fit in a byte; others behind an escape, high byte first."""
    before = 0
    o = 0
    for i in range(n):
        delta = values[i] - before
        before = i32(values[i])
        if -127 <= delta <= 127:
            out[o] = delta
            o += 1
        else:
            out[o] = -128
            out[o + 1] = before >> 8
            out[o + 2] = before & 0xFF
            o += 3
    return o


@kernel
def comb_notches(x: i16[:], n: i32, delay: i32, gain: i32, line: i32[:]) -> None:
    at = 0
    for i in range(n):
        old = line[at]
        fed = x[i] + ((old * gain) >> 15)
        line[at] = fed
        at += 1
        if at == delay:
            at = 0
        x[i] = min(max(old - ((fed * gain) >> 15), -32768), 32767)


@kernel
def isolate_bits(words: u32[:], n: i32, places: u8[:]) -> i32:
    """Where the set bits are, by halves."""
    o = 0
    for i in range(n):
        rest = words[i]
        while rest != 0:
            low = rest & (~rest + 1)
            place = 0
            if (low & 0xFFFF0000) != 0:
                place += 16
            if (low & 0xFF00FF00) != 0:
                place += 8
            if (low & 0xF0F0F0F0) != 0:
                place += 4
            if (low & 0xCCCCCCCC) != 0:
                place += 2
            if (low & 0xAAAAAAAA) != 0:
                place += 1
            places[o] = place
            o += 1
            rest ^= low
    return o


def play_despike(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples = lcg.scaled(200, 300, -150)
    changed = run(samples, 200, 60)
    return samples, word(changed)


def play_tank(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    valve = np.zeros(300, np.uint8)
    switched = run(lcg.scaled(300, 1000, 0, "u2"), 300, 250, 700, valve)
    return valve, word(switched)


def play_heading(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(180, np.uint8)
    run(lcg.bytes(180), 180, 70, out)
    return (out,)


def play_deltas(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    values = np.cumsum([lcg.below(200) - 100 if lcg.below(8) else lcg.below(2000) - 1000 for _ in range(150)])
    out = np.zeros(450, np.int8)
    length = run(values.astype(np.int16), 150, out)
    return out, word(length)


def play_notches(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples, line = lcg.scaled(250, 8000, -4000), np.zeros(23, np.int32)
    run(samples, 250, 23, 20000, line)
    return samples, line


def play_isolate(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    words = np.array([lcg.next() & lcg.next() & lcg.next() for _ in range(40)], np.uint32)
    places = np.zeros(40 * 32, np.uint8)
    count = run(words, 40, places)
    return places, word(count)


CASES = (
    Case(despike, 2754, play_despike, exported=True),
    Case(tank_controller, 2756, play_tank, exported=True),
    Case(smooth_heading, 2757, play_heading, exported=True),
    Case(pack_deltas, 2758, play_deltas, exported=True),
    Case(comb_notches, 2761, play_notches, exported=True),
    Case(isolate_bits, 2762, play_isolate, exported=True),
)
