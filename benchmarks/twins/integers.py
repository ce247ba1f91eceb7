"""Division and loops of unknown length: greatest common divisors, square roots, Collatz, remainders."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def gcd_pairs(a: u16[:], b: u16[:], gcd: u16[:], n: i32) -> None:
    for i in range(n):
        x = u32(a[i])
        y = u32(b[i])
        while y != 0:
            t = x % y
            x = y
            y = t
        gcd[i] = x


@kernel
def newton_sqrt(values: u32[:], roots: u16[:], n: i32) -> None:
    for i in range(n):
        v = values[i]
        x: u32 = 2
        t = v
        while t > 3:
            t >>= 2
            x <<= 1
        y = (x + v // x) >> 1
        while y < x:
            x = y
            y = (x + v // x) >> 1
        roots[i] = x


@kernel
def collatz(steps: u8[:], n: i32) -> i32:
    best = 0
    most = -1
    for i in range(n):
        v = u32(i + 1)
        k = 0
        while v != 1:
            if (v & 1) != 0:
                v = 3 * v + 1
            else:
                v = v >> 1
            k += 1
        steps[i] = k
        if k > most:
            most = k
            best = i + 1
    return best


@kernel
def thirds(a: i16[:], n: i32, out: i16[:]) -> i32:
    check = 0
    for i in range(n):
        total = a[3 * i] + a[3 * i + 1] + a[3 * i + 2]
        out[i] = total // 3
        check = (check * 10 + total) % 97
    return check


def play_gcd(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a, b = (np.array([lcg.u16() for _ in range(20)], np.uint16) for _ in range(2))
    gcd = np.zeros(20, np.uint16)
    run(a, b, gcd, 20)
    return (gcd,)


def play_newton(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    roots = np.zeros(24, np.uint16)
    run(np.array([lcg.next() >> i for i in range(24)], np.uint32), roots, 24)
    return (roots,)


def play_collatz(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    steps = np.zeros(60, np.uint8)
    return steps, word(run(steps, 60))


def play_thirds(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(120, np.int16)
    check = run(lcg.scaled(360, 32768), 120, out)
    return out, word(check)


CASES = (
    Case(gcd_pairs, 1140, play_gcd),
    Case(newton_sqrt, 1142, play_newton),
    Case(collatz, 1144, play_collatz),
    Case(thirds, 1146, play_thirds),
)
