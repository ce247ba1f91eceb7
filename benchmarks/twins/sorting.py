"""More order: selection sort, merge sort, binary search, places of a pattern."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def selection_sort(a: i32[:], n: i32) -> None:
    for i in range(n - 1):
        least = i
        for j in range(i + 1, n):
            if a[j] < a[least]:
                least = j
        t = a[i]
        a[i] = a[least]
        a[least] = t


@kernel
def merge_sort(a: i16[:], b: i16[:], n: i32) -> None:
    width = 1
    while width < n:
        start = 0
        while start < n:
            mid = start + width
            end = mid + width
            if mid > n:
                mid = n
            if end > n:
                end = n
            i = start
            j = mid
            for k in range(start, end):
                if i < mid and (j >= end or a[i] <= a[j]):
                    b[k] = a[i]
                    i += 1
                else:
                    b[k] = a[j]
                    j += 1
            start = end
        for k in range(n):
            a[k] = b[k]
        width = width * 2


@kernel
def lower_bound(table: u16[:], n: i32, keys: u16[:], place: u16[:], m: i32) -> None:
    for i in range(m):
        key = keys[i]
        lo = 0
        hi = n
        while lo < hi:
            mid = (lo + hi) >> 1
            if table[mid] < key:
                lo = mid + 1
            else:
                hi = mid
        place[i] = lo


@kernel
def find_pattern(text: u8[:], n: i32, pattern: u8[:], m: i32, place: u16[:]) -> i32:
    found = 0
    for i in range(n - m + 1):
        j = 0
        while j < m and text[i + j] == pattern[j]:
            j += 1
        if j == m:
            place[found] = i
            found += 1
    return found


@kernel
def count_words(text: u8[:], n: i32, words: u8[:], m: i32, length: i32, count: i32[:]) -> None:
    for k in range(m):
        hits = 0
        for i in range(n - length + 1):
            same = 1
            for j in range(length):
                if text[i + j] != words[k * length + j]:
                    same = 0
                    break
            hits += same
        count[k] = hits


def play_selection(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = np.array([lcg.u16() - 32768 for _ in range(120)], np.int32)
    run(a, 120)
    return (a,)


def play_merge(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = lcg.scaled(128, 20000, -10000)
    run(a, np.zeros(128, np.int16), 128)
    return (a,)


def play_bound(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    table = np.array([400 * i + lcg.below(400) for i in range(150)], np.uint16)
    keys, place = np.array([lcg.u16() for _ in range(200)], np.uint16), np.zeros(200, np.uint16)
    run(table, 150, keys, place, 200)
    return (place,)


def play_pattern(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    text, pattern = lcg.scaled(800, 3, 97, "u1"), lcg.scaled(3, 3, 97, "u1")
    place = np.zeros(800, np.uint16)
    found = run(text, 800, pattern, 3, place)
    return place, word(found)


def play_words(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    text, words = lcg.scaled(300, 4, 97, "u1"), lcg.scaled(8, 4, 97, "u1")
    count = np.zeros(4, np.int32)
    run(text, 300, words, 4, 2, count)
    return (count,)


CASES = (
    Case(count_words, 1243, play_words),
    Case(selection_sort, 1201, play_selection),
    Case(merge_sort, 1221, play_merge),
    Case(lower_bound, 1210, play_bound),
    Case(find_pattern, 1230, play_pattern),
)
