"""Bits of words and bytes: counting them, CRC bit by bit, run lengths."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u32


@kernel
def popcount_words(words: u32[:], count: u8[:], n: i32) -> None:
    for i in range(n):
        w = words[i]
        c = 0
        while w != 0:
            w = w & (w - 1)
            c += 1
        count[i] = c


@kernel
def crc16_bits(data: u8[:], n: i32) -> i32:
    crc = 0xFFFF
    for i in range(n):
        crc = crc ^ (data[i] << 8)
        for _ in range(8):
            if (crc & 0x8000) != 0:
                crc = ((crc << 1) ^ 0x1021) & 0xFFFF
            else:
                crc = (crc << 1) & 0xFFFF
    return crc


@kernel
def bit_runs(words: u32[:], n: i32, runs: u8[:], max_runs: i32) -> i32:
    count = 0
    run = 0
    last: u32 = 0
    for i in range(n):
        w = words[i]
        for _ in range(32):
            bit = w >> 31
            w = w << 1
            if bit == last:
                run = run + 1
            else:
                if count < max_runs:
                    runs[count] = run
                    count = count + 1
                run = 1
                last = bit
    return count


def play_popcount(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    count = np.zeros(1000, np.uint8)
    run(np.array([lcg.next() for _ in range(1000)], np.uint32), count, 1000)
    return (count,)


def play_crc(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    return (word(run(lcg.bytes(200), 200)),)


def play_runs(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    words = np.array([lcg.next() for _ in range(64)], np.uint32)
    runs = np.zeros(1000, np.uint8)
    count = run(words & (words >> 3), 64, runs, 1000)
    return runs, word(count)


CASES = (
    Case(popcount_words, 1109, play_popcount),
    Case(crc16_bits, 1111, play_crc),
    Case(bit_runs, 1113, play_runs),
)
