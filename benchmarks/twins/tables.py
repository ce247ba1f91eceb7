"""Tables: colour classes by two chroma values, binary search."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16


@kernel
def lut2d(u: u8[:], v: u8[:], lut: u8[:], cls: u8[:], count: u16[:], n: i32) -> None:
    for i in range(n):
        k = (u[i] >> 3) * 32 + (v[i] >> 3)
        c = lut[k]
        cls[i] = c
        count[c] = count[c] + 1


@kernel
def table_search(keys: u16[:], n: i32, table: u16[:], m: i32, place: u8[:]) -> None:
    for i in range(n):
        key = keys[i]
        lo = 0
        hi = m
        while lo < hi:
            mid = (lo + hi) >> 1
            if table[mid] <= key:
                lo = mid + 1
            else:
                hi = mid
        place[i] = lo


def play_lut(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    cls, count = np.zeros(1000, np.uint8), np.zeros(8, np.uint16)
    run(lcg.bytes(1000), lcg.bytes(1000), lcg.scaled(1024, 8, kind="u1"), cls, count, 1000)
    return cls, count


def play_search(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    keys = np.array([lcg.u16() for _ in range(200)], np.uint16)
    table = np.array([i * 1000 + lcg.below(1000) for i in range(64)], np.uint16)
    place = np.zeros(200, np.uint8)
    run(keys, 200, table, 64, place)
    return (place,)


CASES = (
    Case(lut2d, 1102, play_lut),
    Case(table_search, 1104, play_search),
)
