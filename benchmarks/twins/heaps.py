"""Order: heap sort, counting sort, median of three neighbours."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def sift_down(a: i16[:], root: i32, end: i32) -> None:
    v = a[root]
    child = 2 * root + 1
    while child < end:
        if child + 1 < end and a[child + 1] > a[child]:
            child += 1
        if a[child] <= v:
            break
        a[root] = a[child]
        root = child
        child = 2 * root + 1
    a[root] = v


@kernel
def heap_sort(a: i16[:], n: i32) -> None:
    for i in range(n // 2 - 1, -1, -1):
        sift_down(a, i, n)
    for end in range(n - 1, 0, -1):
        t = a[0]
        a[0] = a[end]
        a[end] = t
        sift_down(a, 0, end)


@kernel
def counting_sort(src: u8[:], dst: u8[:], count: u16[:], n: i32) -> None:
    for i in range(256):
        count[i] = 0
    for i in range(n):
        count[src[i]] += 1
    for i in range(1, 256):
        count[i] = count[i] + count[i - 1]
    for i in range(n - 1, -1, -1):
        v = src[i]
        k = count[v] - 1
        count[v] = k
        dst[k] = v


@kernel
def median3_row(src: u8[:], dst: u8[:], n: i32) -> None:
    dst[0] = src[0]
    dst[n - 1] = src[n - 1]
    for i in range(1, n - 1):
        a = src[i - 1]
        b = src[i]
        c = src[i + 1]
        if a > b:
            t = a
            a = b
            b = t
        if b > c:
            b = c
            if a > b:
                b = a
        dst[i] = b


def play_heap(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = np.array([lcg.u16() - 32768 for _ in range(200)], np.int16)
    run(a, 200)
    return (a,)


def play_counting(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst, count = np.zeros(1000, np.uint8), np.zeros(256, np.uint16)
    run(lcg.bytes(1000), dst, count, 1000)
    return dst, count


def play_median(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(500, np.uint8)
    run(lcg.bytes(500), dst, 500)
    return (dst,)


CASES = (
    Case(heap_sort, 1114, play_heap),
    Case(counting_sort, 1116, play_counting),
    Case(median3_row, 1118, play_median),
)
