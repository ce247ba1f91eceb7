"""Bits and digits by table and by mask: counts of bits, nearest descriptors, base-64, percentiles."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u32


@kernel
def popcount_table(words: u32[:], n: i32, table: u8[:], counts: u8[:]) -> i32:
    total = 0
    for i in range(n):
        w = words[i]
        c = table[w & 255] + table[(w >> 8) & 255] + table[(w >> 16) & 255] + table[w >> 24]
        counts[i] = c
        total += c
    return total


@kernel
def hamming_pairs(a: u32[:], n: i32, b: u32[:], m: i32, nearest: u8[:], distance: u8[:]) -> None:
    for i in range(n):
        best = 33
        at = 0
        for j in range(m):
            x = a[i] ^ b[j]
            x = x - ((x >> 1) & 0x55555555)
            x = (x & 0x33333333) + ((x >> 2) & 0x33333333)
            x = (x + (x >> 4)) & 0x0F0F0F0F
            x = x + (x >> 8)
            x = x + (x >> 16)
            d = i32(x & 63)
            if d < best:
                best = d
                at = j
        nearest[i] = at
        distance[i] = best


@kernel
def base64_encode(src: u8[:], n: i32, digits: u8[:], dst: u8[:]) -> i32:
    o = 0
    i = 0
    while i + 2 < n:
        v = (src[i] << 16) | (src[i + 1] << 8) | src[i + 2]
        dst[o] = digits[v >> 18]
        dst[o + 1] = digits[(v >> 12) & 63]
        dst[o + 2] = digits[(v >> 6) & 63]
        dst[o + 3] = digits[v & 63]
        i += 3
        o += 4
    if i < n:
        v = src[i] << 16
        if i + 1 < n:
            v |= src[i + 1] << 8
        dst[o] = digits[v >> 18]
        dst[o + 1] = digits[(v >> 12) & 63]
        if i + 1 < n:
            dst[o + 2] = digits[(v >> 6) & 63]
        else:
            dst[o + 2] = 61
        dst[o + 3] = 61
        o += 4
    return o


@kernel
def percentiles(src: u8[:], n: i32, hist: i32[:], shares: u8[:], m: i32, level: u8[:]) -> None:
    for i in range(64):
        hist[i] = 0
    for i in range(n):
        hist[src[i] >> 2] += 1
    for i in range(1, 64):
        hist[i] += hist[i - 1]
    for k in range(m):
        wanted = n * shares[k]
        v = 0
        while hist[v] * 100 < wanted:
            v += 1
        level[k] = 4 * v


def play_popcount(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    words = np.array([lcg.next() for _ in range(300)], np.uint32)
    table, counts = np.bitwise_count(np.arange(256, dtype=np.uint8)), np.zeros(300, np.uint8)
    total = run(words, 300, table, counts)
    return counts, word(total)


def play_hamming(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = np.array([lcg.next() for _ in range(24)], np.uint32)
    b = np.array([lcg.next() for _ in range(30)], np.uint32)
    nearest, distance = np.zeros(24, np.uint8), np.zeros(24, np.uint8)
    run(a, 24, b, 30, nearest, distance)
    return nearest, distance


def play_base64(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(1000, np.uint8)
    length = run(lcg.bytes(500), 500, np.arange(33, 97, dtype=np.uint8), dst)
    return dst, word(length)


def play_percentiles(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    hist, level = np.zeros(64, np.int32), np.zeros(9, np.uint8)
    run(lcg.bytes(800), 800, hist, np.arange(10, 100, 10, dtype=np.uint8), 9, level)
    return hist, level


CASES = (
    Case(popcount_table, 1303, play_popcount),
    Case(hamming_pairs, 1304, play_hamming),
    Case(base64_encode, 1305, play_base64),
    Case(percentiles, 1311, play_percentiles),
)
