"""Streams of bytes: sliding windows, variable-length codes, Manchester code, numbers in text, a hash table."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32


@kernel
def lzss_expand(packed: u8[:], n: i32, out: u8[:]) -> i32:
    at = 0
    i = 0
    while i < n:
        flags = packed[i]
        i += 1
        for _bit in range(8):
            if i >= n:
                break
            if (flags & 1) != 0:
                out[at] = packed[i]
                at += 1
                i += 1
            else:
                distance = packed[i] + 1
                length = packed[i + 1] + 3
                i += 2
                for _k in range(length):
                    out[at] = out[at - distance]
                    at += 1
            flags >>= 1
    return at


@kernel
def huffman_decode(code: u8[:], counts: u8[:], symbols: u8[:], out: u8[:], n: i32) -> i32:
    at = 0
    for i in range(n):
        value = 0
        first = 0
        index = 0
        length = 0
        while True:
            value |= (code[at >> 3] >> (7 - (at & 7))) & 1
            at += 1
            length += 1
            count = counts[length]
            if value - first < count:
                out[i] = symbols[index + value - first]
                break
            index += count
            first = (first + count) << 1
            value <<= 1
    return at


@kernel
def manchester_decode(levels: u8[:], n: i32, out: u8[:]) -> i32:
    bits = 0
    taken = 0
    found = 0
    length = 1
    mid = 0
    for i in range(1, n):
        if levels[i] == levels[i - 1]:
            length += 1
            continue
        if length > 6:
            mid = 1
        elif mid != 0:
            mid = 0
            length = 1
            continue
        else:
            mid = 1
        length = 1
        bits = ((bits << 1) | levels[i]) & 255
        taken += 1
        if taken == 8:
            out[found] = bits
            found += 1
            taken = 0
    return found


@kernel
def parse_numbers(text: u8[:], n: i32, numbers: i32[:]) -> i32:
    found = 0
    i = 0
    while i < n:
        c = text[i]
        if c == 32 or c == 44:
            i += 1
            continue
        negative = False
        if c == 45:
            negative = True
            i += 1
        value = 0
        while i < n and 48 <= text[i] <= 57:
            value = value * 10 + text[i] - 48
            i += 1
        numbers[found] = -value if negative else value
        found += 1
    return found


@kernel
def hash_count(keys: u16[:], n: i32, table: u16[:], counts: u8[:]) -> i32:
    probes = 0
    for i in range(n):
        key = keys[i]
        slot = ((u32(key) * 40503) >> 7) & 127
        while table[slot] != key and table[slot] != 0:
            slot = (slot + 1) & 127
            probes += 1
        table[slot] = key
        if counts[slot] < 255:
            counts[slot] += 1
    return probes


def play_lzss(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    packed, length = [], 0
    for _ in range(40):
        flags = lcg.u8() | (1 if not length else 0)
        packed.append(flags)
        for bit in range(8):
            if flags >> bit & 1:
                packed.append(lcg.u8())
                length += 1
            else:
                packed += [lcg.below(min(length, 256)), lcg.below(12)]
                length += packed[-1] + 3
    out = np.zeros(length, np.uint8)
    written = run(np.array(packed, np.uint8), len(packed), out)
    return out, word(written)


def play_huffman(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    counts = np.array([0, 0, 2, 2, 2, 4, 0, 0, 0], np.uint8)  # lengths 2, 2, 3, 3, 4, 4, 5, 5, 5, 5
    symbols = np.arange(65, 75, dtype=np.uint8)
    out = np.zeros(400, np.uint8)
    bits = run(lcg.bytes(300), counts, symbols, out, 400)
    return out, word(bits)


def play_manchester(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    halves = [each for _ in range(70) for each in ((0, 1) if lcg.u8() & 1 else (1, 0))]
    levels = np.repeat(np.array(halves, np.uint8), [4 + lcg.below(2) for _ in halves])
    out = np.zeros(20, np.uint8)
    found = run(levels, len(levels), out)
    return out, word(found)


def play_numbers(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    text = ", ".join(str(lcg.below(20000) - 10000 >> lcg.below(12)) for _ in range(100)).encode()
    numbers = np.zeros(120, np.int32)
    found = run(np.frombuffer(text, np.uint8).copy(), len(text), numbers)
    return numbers, word(found)


def play_hash(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    keys = (lcg.scaled(400, 90, 1, "i4") ** 2).astype(np.uint16)
    table, counts = np.zeros(128, np.uint16), np.zeros(128, np.uint8)
    probes = run(keys, 400, table, counts)
    return table, counts, word(probes)


CASES = (
    Case(lzss_expand, 2101, play_lzss, exported=True),
    Case(huffman_decode, 2102, play_huffman, exported=True),
    Case(manchester_decode, 2103, play_manchester, exported=True),
    Case(parse_numbers, 2104, play_numbers, exported=True),
    Case(hash_count, 2105, play_hash, exported=True),
)
