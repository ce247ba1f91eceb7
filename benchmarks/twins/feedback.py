"""Loops of signals and control: filters, medians, loudness, gain, speeds of axes, attitude, widths of pulses, pitch."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def double_rate(src: i16[:], taps: i16[:], dst: i16[:], n: i32) -> None:
    """Interpolate by two: `taps` has 8 of the even phase, then 8 of the odd one."""
    for i in range(n):
        even = 0
        odd = 0
        for k in range(8):
            v = src[i + 7 - k]
            even += v * taps[k]
            odd += v * taps[8 + k]
        dst[2 * i] = even >> 15
        dst[2 * i + 1] = odd >> 15


@kernel
def saturated(v: i32) -> i32:
    return min(max(v, -32768), 32767)


@kernel
def biquad_cascade(x: i16[:], coefficients: i16[:], state: i32[:], y: i16[:], n: i32, sections: i32) -> None:
    for i in range(n):
        v = i32(x[i])
        for s in range(sections):
            c = 5 * s
            k = 2 * s
            out = saturated((coefficients[c] * v + state[k]) >> 14)
            state[k] = coefficients[c + 1] * v - coefficients[c + 3] * out + state[k + 1]
            state[k + 1] = coefficients[c + 2] * v - coefficients[c + 4] * out
            v = out
        y[i] = v


@kernel
def median5_stream(x: i16[:], y: i16[:], n: i32) -> None:
    for i in range(2, n - 2):
        a = x[i - 2]
        b = x[i - 1]
        c = x[i]
        d = x[i + 1]
        e = x[i + 2]
        if a > b:
            a, b = b, a
        if d > e:
            d, e = e, d
        low = max(a, d)
        high = min(b, e)
        y[i] = max(min(low, high), min(max(low, high), c))


@kernel
def root16(v: i32) -> i32:
    r = 0
    b = 0x4000
    while b > 0:
        t = r | b
        if t * t <= v:
            r = t
        b >>= 1
    return r


@kernel
def loudness(x: i16[:], out: i16[:], n: i32, window: i32) -> None:
    """Root of the mean square of the last `window` samples, a power of two."""
    energy = 0
    for i in range(n):
        v = x[i] >> 4
        energy += v * v
        if i >= window:
            old = x[i - window] >> 4
            energy -= old * old
        out[i] = root16(energy // window)


@kernel
def automatic_gain(x: i16[:], y: i16[:], n: i32, target: i32) -> i32:
    gain = 256
    peak = 0
    for i in range(n):
        v = (x[i] * gain) >> 8
        level = abs(v)
        if level > peak:
            peak += (level - peak) >> 2
        else:
            peak -= peak >> 6
        if peak > target and gain > 16:
            gain -= gain >> 5
        elif peak < target - (target >> 3) and gain < 4096:
            gain += 1
        y[i] = min(max(v, -32768), 32767)
    return gain


@kernel
def trapezoid_speed(positions: i32[:], speeds: i16[:], n: i32, goal: i32, limit: i32, slope: i32) -> None:
    position = 0
    speed = 0
    for i in range(n):
        rest = goal - position
        braking = (speed * speed) // (2 * slope)
        if rest <= braking:
            speed = max(speed - slope, 0)
        elif speed < limit:
            speed = min(speed + slope, limit)
        position += speed
        positions[i] = position
        speeds[i] = speed


@kernel
def complementary(gyro: i16[:], level: i16[:], angle: i16[:], n: i32, start: i32) -> i32:
    a = start << 8
    for i in range(n):
        a += gyro[i] * 5
        wrong = (level[i] << 8) - a
        if wrong > 1 << 15:
            wrong -= 1 << 16
        a += wrong >> 6
        angle[i] = a >> 8
    return a


@kernel
def pulse_widths(pins: u8[:], widths: u16[:], n: i32, mask: i32, room: i32) -> i32:
    count = 0
    since = 0
    before = 0
    for t in range(n):
        now = pins[t] & mask
        if now != before:
            if now:
                since = t
            elif count < room:
                widths[count] = t - since
                count += 1
            before = now
    return count


@kernel
def pitch_lag(x: i16[:], n: i32, shortest: i32, longest: i32) -> i32:
    best = -0x7FFFFFFF
    found = 0
    for lag in range(shortest, longest):
        total = 0
        for i in range(n - longest):
            total += (x[i] * x[i + lag]) >> 6
        if total > best:
            best = total
            found = lag
    return found


def play_rate(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(200, np.int16)
    run(lcg.scaled(107, 40000, -20000), lcg.scaled(16, 8000, -3000), dst, 100)
    return (dst,)


def play_cascade(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    coefficients = np.array([1200, 2400, 1200, -18000, 6500] * 3, np.int16)
    state, y = np.zeros(6, np.int32), np.zeros(120, np.int16)
    run(lcg.scaled(120, 8000, -4000), coefficients, state, y, 120, 3)
    return state, y


def play_stream(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    y = np.zeros(250, np.int16)
    run(lcg.scaled(250, 4000, -2000), y, 250)
    return (y,)


def play_loudness(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(80, np.int16)
    run(lcg.scaled(80, 20000, -10000), out, 80, 16)
    return (out,)


def play_gain(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    y = np.zeros(300, np.int16)
    gain = run(lcg.scaled(300, 30000, -15000), y, 300, 6000)
    return y, word(gain)


def play_speed(_: Lcg, run: Run) -> tuple[Array, ...]:
    positions, speeds = np.zeros(150, np.int32), np.zeros(150, np.int16)
    run(positions, speeds, 150, 20000, 200, 5)
    return positions, speeds


def play_complementary(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    angle = np.zeros(200, np.int16)
    end = run(lcg.scaled(200, 200, -100), lcg.scaled(200, 60, -30), angle, 200, 12)
    return angle, word(end)


def play_widths(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    pins = np.array([lcg.u8() for _ in range(100)], np.uint8).repeat(5)
    widths = np.zeros(40, np.uint16)
    count = run(pins, widths, 500, 4, 40)
    return widths, word(count)


def play_pitch(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    x = (3000 * np.sin(np.arange(200) * 0.21)).astype(np.int16) + lcg.scaled(200, 400, -200)
    return (word(run(x, 200, 16, 48)),)


CASES = (
    Case(double_rate, 1831, play_rate, exported=True),
    Case(biquad_cascade, 1832, play_cascade, exported=True),
    Case(median5_stream, 1833, play_stream, exported=True),
    Case(loudness, 1834, play_loudness, exported=True),
    Case(automatic_gain, 1835, play_gain, exported=True),
    Case(trapezoid_speed, 1836, play_speed, exported=True),
    Case(complementary, 1837, play_complementary, exported=True),
    Case(pulse_widths, 1838, play_widths, exported=True),
    Case(pitch_lag, 1839, play_pitch, exported=True),
)
