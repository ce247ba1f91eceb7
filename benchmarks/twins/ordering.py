"""Order: Shell sort, quicksort without recursion, median of nine pixels."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8


@kernel
def shell_sort(a: i32[:], n: i32) -> None:
    gap = n >> 1
    while gap > 0:
        for i in range(gap, n):
            v = a[i]
            j = i
            while j >= gap and a[j - gap] > v:
                a[j] = a[j - gap]
                j = j - gap
            a[j] = v
        gap = gap >> 1


@kernel
def quick_sort(a: i16[:], stack: i16[:], n: i32) -> None:
    sp = 2
    stack[0] = 0
    stack[1] = n - 1
    while sp > 0:
        sp = sp - 2
        lo = stack[sp]
        hi = stack[sp + 1]
        while lo < hi:
            pivot = a[(lo + hi) >> 1]
            i = lo
            j = hi
            while i <= j:
                while a[i] < pivot:
                    i += 1
                while a[j] > pivot:
                    j -= 1
                if i <= j:
                    t = a[i]
                    a[i] = a[j]
                    a[j] = t
                    i += 1
                    j -= 1
            if j - lo < hi - i:
                if i < hi:
                    stack[sp] = i
                    stack[sp + 1] = hi
                    sp = sp + 2
                hi = j
            else:
                if lo < j:
                    stack[sp] = lo
                    stack[sp + 1] = j
                    sp = sp + 2
                lo = i


@kernel
def median9_row(r0: u8[:], r1: u8[:], r2: u8[:], out: u8[:], w: i32) -> None:
    for x in range(1, w - 1):
        a = r0[x - 1]
        b = r1[x - 1]
        c = r2[x - 1]
        p = min(a, b)
        q = max(a, b)
        low = min(p, c)
        high = max(q, c)
        m0 = max(p, min(q, c))

        a = r0[x]
        b = r1[x]
        c = r2[x]
        p = min(a, b)
        q = max(a, b)
        low = max(low, min(p, c))
        high = min(high, max(q, c))
        m1 = max(p, min(q, c))

        a = r0[x + 1]
        b = r1[x + 1]
        c = r2[x + 1]
        p = min(a, b)
        q = max(a, b)
        low = max(low, min(p, c))
        high = min(high, max(q, c))
        m2 = max(p, min(q, c))

        mid = max(min(m0, m1), min(max(m0, m1), m2))
        out[x] = max(min(low, mid), min(max(low, mid), high))


def play_shell(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = np.array([lcg.u16() - 32768 for _ in range(200)], np.int32)
    run(a, 200)
    return (a,)


def play_quick(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = lcg.scaled(300, 2000, -1000)
    run(a, np.zeros(40, np.int16), 300)
    return (a,)


def play_median(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(160, np.uint8)
    run(lcg.bytes(160), lcg.bytes(160), lcg.bytes(160), out, 160)
    return (out,)


CASES = (
    Case(shell_sort, 1115, play_shell),
    Case(quick_sort, 1117, play_quick),
    Case(median9_row, 1119, play_median),
)
