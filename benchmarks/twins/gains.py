"""16-bit fixed point: low passes in a row, lengths of vectors, turned points, sines of a sweep, mixed channels."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u16


@kernel
def saturated(value: i32) -> i32:
    if value > 32767:
        return 32767
    if value < -32768:
        return -32768
    return value


@kernel
def low_passes(samples: i16[:], n: i32, state: i16[:], poles: i16[:], count: i32) -> None:
    for i in range(n):
        v = samples[i]
        for p in range(count):
            held = state[p]
            held = saturated(held + ((poles[p] * (v - held) + 0x4000) >> 15))
            state[p] = held
            v = held
        samples[i] = saturated(2 * v)


@kernel
def vector_lengths(dx: i16[:], dy: i16[:], n: i32, out: u16[:]) -> i32:
    longest = -1
    most = 0
    for i in range(n):
        a = abs(dx[i])
        b = abs(dy[i])
        if a < b:
            swapped = a
            a = b
            b = swapped
        length = a - (a >> 5) - (a >> 7) + (b >> 2) + (b >> 6)
        if b * 4 > a * 3:
            length += (b >> 3) - (a >> 6)
        length = max(length, a)
        out[i] = length
        if length > most:
            most = length
            longest = i
    return longest


@kernel
def turn_points(points: i16[:], n: i32, turn: i16[:], shift: i16[:], out: i16[:]) -> None:
    for i in range(n):
        for r in range(3):
            total = 1 << 13
            for c in range(3):
                total += turn[3 * r + c] * points[3 * i + c]
            out[3 * i + r] = saturated((total >> 14) + shift[r])


@kernel
def sine(phase: i32) -> i32:
    x = i32(i16(phase))
    if x > 16384:
        x = 32768 - x
    elif x < -16384:
        x = -32768 - x
    x *= 2
    square = (x * x) >> 15
    y = 2380 - ((square * 143) >> 15)
    y = 21165 - ((square * y) >> 15)
    y = 51472 - ((square * y) >> 15)
    return (x * y) >> 15


@kernel
def sweep(out: i16[:], n: i32, start: i32, stop: i32, level: i32) -> i32:
    phase = 0
    step = start << 8
    gain = ((stop - start) << 8) // n
    for i in range(n):
        out[i] = (level * min(sine(phase >> 8), 32767)) >> 15
        phase += step
        step += gain
    return phase


@kernel
def mix_channels(a: i16[:], b: i16[:], n: i32, left: i16[:], right: i16[:], fade: i32) -> i32:
    clipped = 0
    gain = 0x7FFF
    for i in range(n):
        x = (a[i] * gain) >> 15
        y = (b[i] * (0x7FFF - gain)) >> 15
        middle = x + (y >> 1)
        side = y + (x >> 1)
        if middle > 32767 or middle < -32768 or side > 32767 or side < -32768:
            clipped += 1
        left[i] = min(max(middle, -32768), 32767)
        right[i] = min(max(side, -32768), 32767)
        if (i & 15) == 15 and gain > fade:
            gain -= fade
    return clipped


def play_low(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples, state = lcg.scaled(160, 60000, -30000), np.zeros(3, np.int16)
    run(samples, 160, state, np.array([20000, 12000, 9000], np.int16), 3)
    return samples, state


def play_lengths(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(250, np.uint16)
    longest = run(lcg.scaled(250, 40000, -20000), lcg.scaled(250, 40000, -20000), 250, out)
    return out, word(longest)


def play_turn(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(240, np.int16)
    turn = np.array([14189, -8192, 0, 8192, 14189, 0, 0, 0, 16384], np.int16)
    run(lcg.scaled(240, 16000, -8000), 80, turn, lcg.scaled(3, 30000, -15000), out)
    return (out,)


def play_sweep(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(300, np.int16)
    phase = run(out, 300, 100 + lcg.below(100), 3000, 28000)
    return out, word(phase)


def play_mix(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    left, right = (np.zeros(300, np.int16) for _ in range(2))
    a, b = (lcg.scaled(300, 65536, -32768, "i4").astype(np.int16) for _ in range(2))
    clipped = run(a, b, 300, left, right, 1500)
    return left, right, word(clipped)


CASES = (
    Case(low_passes, 2631, play_low, exported=True),
    Case(vector_lengths, 2632, play_lengths, exported=True),
    Case(turn_points, 2633, play_turn, exported=True),
    Case(sweep, 2634, play_sweep, exported=True),
    Case(mix_channels, 2635, play_mix, exported=True),
)
