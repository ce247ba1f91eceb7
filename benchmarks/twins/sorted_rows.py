"""Sorted rows: one step back after each exchange, a curve by bisection, two rows merged without what occurs twice."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u16


@kernel
def gnome_sort(a: i16[:], n: i32) -> None:
    i = 1
    while i < n:
        if i == 0 or a[i] >= a[i - 1]:
            i = i + 1
        else:
            t = a[i]
            a[i] = a[i - 1]
            a[i - 1] = t
            i = i - 1


@kernel
def curve_lookup(x: u16[:], y: u16[:], slope: i16[:], points: i32, xs: u16[:], out: i32[:], n: i32) -> None:
    for i in range(n):
        v = xs[i]
        lo = 0
        hi = points - 1
        while hi - lo > 1:
            mid = (lo + hi) >> 1
            if x[mid] > v:
                hi = mid
            else:
                lo = mid
        out[i] = y[lo] + (((v - x[lo]) * slope[lo]) >> 8)


@kernel
def merge_once(a: u16[:], b: u16[:], out: u16[:], n: i32) -> i32:
    i = 0
    j = 0
    k = 0
    while i < n and j < n:
        p = a[i]
        q = b[j]
        if p < q:
            out[k] = p
            i += 1
        else:
            if p == q:
                i += 1
            out[k] = q
            j += 1
        k += 1
    return k


def play_gnome(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = np.array([lcg.u16() for _ in range(60)], np.uint16).view(np.int16)
    run(a, 60)
    return (a,)


def play_curve(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    x = np.array([1000 * i + lcg.below(1000) for i in range(40)], np.uint16)
    y = np.array([lcg.u16() for _ in range(40)], np.uint16)
    slope = np.array([lcg.u16() for _ in range(40)], np.uint16).view(np.int16)
    xs, out = np.array([lcg.below(40000) for _ in range(300)], np.uint16), np.zeros(300, np.int32)
    run(x, y, slope, 40, xs, out, 300)
    return (out,)


def play_merge(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a, b = (np.array([4 * i + lcg.below(4) for i in range(200)], np.uint16) for _ in range(2))
    out = np.zeros(400, np.uint16)
    return out, word(run(a, b, out, 200))


CASES = (
    Case(gnome_sort, 2101, play_gnome),
    Case(curve_lookup, 2102, play_curve),
    Case(merge_once, 2103, play_merge),
)
