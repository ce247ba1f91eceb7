"""Packed data: runs of bytes and back, fields of many widths, a checksum of two sums, records in hexadecimal."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32


@kernel
def pack_runs(source: u8[:], n: i32, out: u8[:]) -> i32:
    i = 0
    o = 0
    while i < n:
        run = 1
        while i + run < n and run < 128 and source[i + run] == source[i]:
            run += 1
        if run > 2:
            out[o] = 257 - run
            out[o + 1] = source[i]
            o += 2
            i += run
            continue
        start = i
        i += run
        while i < n and i - start < 128:
            if i + 2 < n and source[i] == source[i + 1] and source[i] == source[i + 2]:
                break
            i += 1
        out[o] = i - start - 1
        o += 1
        for k in range(start, i):
            out[o] = source[k]
            o += 1
    return o


@kernel
def unpack_runs(packed: u8[:], n: i32, out: u8[:], most: i32) -> i32:
    i = 0
    o = 0
    while i < n:
        head = packed[i]
        i += 1
        if head < 128:
            count = head + 1
            if o + count > most:
                return -1
            for k in range(count):
                out[o + k] = packed[i + k]
            i += count
            o += count
        elif head > 128:
            count = 257 - head
            value = packed[i]
            i += 1
            while count > 0 and o < most:
                out[o] = value
                o += 1
                count -= 1
    return o


@kernel
def read_fields(words: u32[:], widths: u8[:], n: i32, out: u16[:]) -> u32:
    at = 0
    left = 32
    held = words[0]
    parity: u32 = 0
    for i in range(n):
        width = widths[i]
        if width <= left:
            value = held & ((u32(1) << u32(width)) - 1)
            held >>= u32(width)
            left -= width
            if left == 0:
                at += 1
                held = words[at]
                left = 32
        else:
            value = held
            at += 1
            held = words[at]
            rest = width - left
            value |= (held & ((u32(1) << u32(rest)) - 1)) << u32(left)
            held >>= u32(rest)
            left = 32 - rest
        out[i] = value
        parity ^= value
    return parity


@kernel
def two_sums(data: u8[:], n: i32) -> u32:
    a: u32 = 1
    b: u32 = 0
    at = 0
    while at < n:
        stop = min(at + 64, n)
        while at < stop:
            a += u32(data[at])
            b += a
            at += 1
        a %= 65521
        b %= 65521
    return (b << 16) | a


@kernel
def hex_digit(letter: i32) -> i32:
    if letter >= 48 and letter <= 57:
        return letter - 48
    if letter >= 65 and letter <= 70:
        return letter - 55
    return -1


@kernel
def hex_records(text: u8[:], n: i32, out: u8[:]) -> i32:
    state = 0
    count = 0
    total = 0
    half = 0
    value = 0
    o = 0
    bad = 0
    for i in range(n):
        letter = text[i]
        if letter == 58:
            state = 1
            half = 0
            total = 0
            continue
        if state == 0:
            continue
        digit = hex_digit(letter)
        if digit < 0:
            state = 0
            bad += 1
            continue
        value = (value << 4) | digit
        half ^= 1
        if half == 1:
            continue
        value &= 255
        total += value
        if state == 1:
            count = value
            state = 2
        elif count > 0:
            out[o] = value
            o += 1
            count -= 1
        else:
            if (total & 255) != 0:
                bad += 1
            state = 0
    return (bad << 16) | o


def runs(lcg: Lcg, n: int) -> Array:
    values = [[lcg.u8()] * (1 + lcg.below(9) * lcg.below(2)) for _ in range(n)]
    return np.array([each for run in values for each in run][:n], np.uint8)


def packed(data: Array) -> Array:
    """Pack runs of equal bytes, everything else byte by byte."""
    out, i = list[int](), 0
    while i < len(data):
        n = 1
        while n < 128 and i + n < len(data) and data[i + n] == data[i]:
            n += 1
        out += [257 - n, int(data[i])] if n > 1 else [0, int(data[i])]
        i += n
    return np.array(out, np.uint8)


def play_pack(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(1200, np.uint8)
    length = run(runs(lcg, 500), 500, out)
    return out, word(length)


def play_unpack(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    data, out = packed(runs(lcg, 400)), np.zeros(512, np.uint8)
    length = run(data, len(data), out, 512)
    return out, word(length)


def play_fields(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    words = np.array([lcg.next() for _ in range(120)], np.uint32)
    out = np.zeros(300, np.uint16)
    parity = run(words, lcg.scaled(300, 12, 1, "u1"), 300, out)
    return out, np.array([parity], np.uint32)


def play_sums(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    return (np.array([run(lcg.bytes(700), 700)], np.uint32),)


def play_records(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    lines = []
    for _ in range(12):
        data = [lcg.u8() for _ in range(8)]
        octets = [8, *data]
        octets.append(-sum(octets) & 255 if lcg.below(5) else 0)
        lines.append(":" + "".join(f"{each:02X}" for each in octets) + "\r\n")
    text, out = np.frombuffer("".join(lines).encode(), np.uint8).copy(), np.zeros(200, np.uint8)
    found = run(text, len(text), out)
    return out, word(found)


CASES = (
    Case(pack_runs, 2611, play_pack, exported=True),
    Case(unpack_runs, 2612, play_unpack, exported=True),
    Case(read_fields, 2613, play_fields, exported=True),
    Case(two_sums, 2614, play_sums, exported=True),
    Case(hex_records, 2615, play_records, exported=True),
)
