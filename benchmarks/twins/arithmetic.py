"""Arithmetic without a library: roots, angles, logarithms, sines, division by shifts, decimals, powers, random numbers, halves of floats."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u16, u32


@kernel
def root_by_bits(values: u32[:], out: u16[:], n: i32) -> None:
    for i in range(n):
        rest = values[i]
        root: u32 = 0
        bit: u32 = 1 << 30
        while bit > rest:
            bit >>= 2
        while bit:
            if rest >= root + bit:
                rest -= root + bit
                root = (root >> 1) + bit
            else:
                root >>= 1
            bit >>= 2
        out[i] = root


@kernel
def angle_q13(y: i32, x: i32) -> i32:
    """The angle of a vector, 8192 to a quarter of a turn, by a polynomial of degree two in each octant."""
    ay = abs(y)
    ax = abs(x)
    if ax == 0 and ay == 0:
        return 0
    if ax >= ay:
        t = (ay << 12) // ax
        a = t + ((t * (4096 - t)) >> 14)
    else:
        t = (ax << 12) // ay
        a = 8192 - t - ((t * (4096 - t)) >> 14)
    if x < 0:
        a = 16384 - a
    return -a if y < 0 else a


@kernel
def angles_of(xs: i16[:], ys: i16[:], out: i16[:], n: i32) -> None:
    for i in range(n):
        out[i] = angle_q13(ys[i], xs[i])


@kernel
def log2_q8(values: u32[:], out: i16[:], n: i32) -> None:
    for i in range(n):
        v = values[i]
        whole = 31
        while whole > 0 and v < 0x80000000:
            v <<= 1
            whole -= 1
        m = v >> 16
        result = whole << 8
        for k in range(8):
            m = (m * m) >> 15
            if m >= 0x10000:
                m >>= 1
                result |= 128 >> k
        out[i] = result


@kernel
def quarter_sines(phases: u16[:], quarter: i16[:], out: i16[:], n: i32) -> None:
    for i in range(n):
        p = phases[i] >> 6
        k = p & 255
        side = p >> 8
        if side & 1:
            k = 256 - k
        v = quarter[k]
        out[i] = -v if side & 2 else v


@kernel
def long_division(a: u16[:], b: u16[:], quotients: u16[:], rests: u16[:], n: i32) -> None:
    for i in range(n):
        num = a[i]
        den = b[i]
        rest = 0
        result = 0
        for _ in range(16):
            rest = (rest << 1) | ((num >> 15) & 1)
            num <<= 1
            result <<= 1
            if rest >= den:
                rest -= den
                result |= 1
        quotients[i] = result
        rests[i] = rest


@kernel
def double_dabble(values: u16[:], bcd: u32[:], n: i32) -> None:
    for i in range(n):
        v = values[i]
        digits = 0
        for bit in range(16):
            for place in range(0, 20, 4):
                if (digits >> place) & 15 >= 5:
                    digits += 3 << place
            digits = (digits << 1) | ((v >> (15 - bit)) & 1)
        bcd[i] = u32(digits)


@kernel
def powers_modulo(bases: u16[:], out: u16[:], n: i32, exponent: i32, modulus: i32) -> None:
    for i in range(n):
        b = u32(bases[i]) % u32(modulus)
        e = exponent
        result: u32 = 1
        while e > 0:
            if e & 1:
                result = result * b % u32(modulus)
            b = b * b % u32(modulus)
            e >>= 1
        out[i] = result


@kernel
def shuffle_indices(order: u16[:], n: i32, seed: u32) -> u32:
    state = seed
    for i in range(n):
        order[i] = i
    for i in range(n - 1, 0, -1):
        state ^= state << 13
        state ^= state >> 17
        state ^= state << 5
        j = ((state >> 16) * u32(i + 1)) >> 16
        t = order[i]
        order[i] = order[j]
        order[j] = t
    return state


@kernel
def half_floats(values: i32[:], out: u16[:], n: i32) -> None:
    for i in range(n):
        v = values[i]
        sign = 0
        if v < 0:
            sign = 0x8000
            v = -v
        if v == 0:
            out[i] = sign
            continue
        exponent = 25
        while v >= 2048:
            v >>= 1
            exponent += 1
        while v < 1024:
            v <<= 1
            exponent -= 1
        out[i] = sign | (min(exponent, 31) << 10) | (v & 1023)


def words_of(lcg: Lcg, n: int) -> Array:
    return np.array([lcg.next() >> lcg.below(24) for _ in range(n)], np.uint32)


def play_roots(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(60, np.uint16)
    run(words_of(lcg, 60) + np.uint32(1), out, 60)
    return (out,)


def play_angles(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(100, np.int16)
    run(lcg.scaled(100, 2000, -1000), lcg.scaled(100, 2000, -1000), out, 100)
    return (out,)


def play_logs(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(60, np.int16)
    run(words_of(lcg, 60) | np.uint32(1), out, 60)
    return (out,)


def play_sines(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    quarter = np.round(32767 * np.sin(np.arange(257) * np.pi / 512)).astype(np.int16)
    out = np.zeros(200, np.int16)
    run(np.array([lcg.u16() for _ in range(200)], np.uint16), quarter, out, 200)
    return (out,)


def play_division(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a, b = lcg.scaled(60, 65536, 0, "u2"), lcg.scaled(60, 500, 1, "u2")
    quotients, rests = np.zeros(60, np.uint16), np.zeros(60, np.uint16)
    run(a, b, quotients, rests, 60)
    return quotients, rests


def play_dabble(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    bcd = np.zeros(30, np.uint32)
    run(lcg.scaled(30, 65536, 0, "u2"), bcd, 30)
    return (bcd,)


def play_powers(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(20, np.uint16)
    run(lcg.scaled(20, 60000, 0, "u2"), out, 20, 65537 % 60000, 40487)
    return (out,)


def play_shuffle(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    order = np.zeros(200, np.uint16)
    run(order, 200, lcg.next() | 1)
    return (order,)


def play_halves(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    values = np.array([(lcg.u16() - 32768) >> lcg.below(12) for _ in range(120)], np.int32)
    out = np.zeros(120, np.uint16)
    run(values, out, 120)
    return (out,)


CASES = (
    Case(root_by_bits, 1821, play_roots, exported=True),
    Case(angles_of, 1822, play_angles, exported=True),
    Case(log2_q8, 1823, play_logs, exported=True),
    Case(quarter_sines, 1824, play_sines, exported=True),
    Case(long_division, 1825, play_division, exported=True),
    Case(double_dabble, 1826, play_dabble, exported=True),
    Case(powers_modulo, 1827, play_powers, exported=True),
    Case(shuffle_indices, 1828, play_shuffle, exported=True),
    Case(half_floats, 1829, play_halves, exported=True),
)
