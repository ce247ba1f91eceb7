"""Messages of a serial line: a checksum with end-around carry, escaped packets, numbers of many lengths, five bits a letter, commands."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32


@kernel
def folded_sum(words: u16[:], n: i32) -> u32:
    total: u32 = 0
    for i in range(n):
        total += u32(words[i])
    while total >> 16:
        total = (total & 0xFFFF) + (total >> 16)
    return total ^ 0xFFFF


@kernel
def open_packets(line: u8[:], n: i32, out: u8[:], lengths: u8[:]) -> i32:
    packets = 0
    o = 0
    start = 0
    escaped = False
    for i in range(n):
        octet = line[i]
        if octet == 0xC0:
            if o > start:
                lengths[packets] = o - start
                packets += 1
            start = o
            escaped = False
        elif octet == 0xDB:
            escaped = True
        elif escaped:
            escaped = False
            if octet == 0xDC:
                out[o] = 0xC0
                o += 1
            elif octet == 0xDD:
                out[o] = 0xDB
                o += 1
            else:
                o = start
        else:
            out[o] = octet
            o += 1
    return packets


@kernel
def read_varints(data: u8[:], n: i32, values: u32[:], most: i32) -> i32:
    found = 0
    i = 0
    while i < n and found < most:
        value: u32 = 0
        shift: u32 = 0
        while True:
            octet = data[i]
            i += 1
            value |= u32(octet & 127) << shift
            if octet < 128 or i >= n:
                break
            shift += 7
            if shift > 28:
                return -1
        values[found] = value
        found += 1
    return found


@kernel
def five_bits(data: u8[:], n: i32, alphabet: u8[:], out: u8[:]) -> i32:
    held: u32 = 0
    bits = 0
    o = 0
    for i in range(n):
        held = (held << 8) | u32(data[i])
        bits += 8
        while bits >= 5:
            bits -= 5
            out[o] = alphabet[(held >> u32(bits)) & 31]
            o += 1
    if bits > 0:
        out[o] = alphabet[(held << u32(5 - bits)) & 31]
        o += 1
    return o


@kernel
def is_digit(letter: i32) -> i32:
    return 1 if letter >= 48 and letter <= 57 else 0


@kernel
def read_commands(text: u8[:], n: i32, codes: u8[:], arguments: i32[:]) -> i32:
    found = 0
    i = 0
    while i < n:
        letter = text[i]
        if letter < 65 or letter > 90:
            i += 1
            continue
        i += 1
        sign = 1
        if i < n and text[i] == 45:
            sign = -1
            i += 1
        value = 0
        digits = 0
        while i < n and is_digit(text[i]) == 1:
            value = value * 10 + (text[i] - 48)
            digits += 1
            i += 1
        if digits == 0:
            continue
        codes[found] = letter
        arguments[found] = sign * value
        found += 1
    return found


def play_folded(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    data = np.array([lcg.u16() for _ in range(500)], np.uint16)
    return (np.array([run(data, 500)], np.uint32),)


def play_packets(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    marks = (0xC0, 0xDB, 0xDC, 0xDD)
    line = [marks[lcg.below(4)] if lcg.below(6) == 0 else lcg.u8() for _ in range(600)]
    out, lengths = np.zeros(600, np.uint8), np.zeros(300, np.uint8)
    packets = run(np.array(line, np.uint8), 600, out, lengths)
    return out, lengths, word(packets)


def play_varints(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    data = list[int]()
    for _ in range(120):
        value = lcg.next() >> (4 + lcg.below(28))
        while value > 127:
            data.append(value & 127 | 128)
            value >>= 7
        data.append(value)
    values = np.zeros(120, np.uint32)
    found = run(np.array(data, np.uint8), len(data), values, 120)
    return values, word(found)


def play_five(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    alphabet = np.frombuffer(b"ABCDEFGHIJKLMNOPQRSTUVWXYZ234567", np.uint8).copy()
    out = np.zeros(400, np.uint8)
    length = run(lcg.bytes(202), 202, alphabet, out)
    return out, word(length)


def play_commands(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    parts = [
        f"{'GXYZFM '[lcg.below(7)]}{'-' * (lcg.below(4) == 0)}{lcg.below(2000) * (lcg.below(9) > 0) or ''} "
        for _ in range(80)
    ]
    text = np.frombuffer("".join(parts).encode(), np.uint8).copy()
    codes, arguments = np.zeros(100, np.uint8), np.zeros(100, np.int32)
    found = run(text, len(text), codes, arguments)
    return codes, arguments, word(found)


CASES = (
    Case(folded_sum, 2731, play_folded, exported=True),
    Case(open_packets, 2732, play_packets, exported=True),
    Case(read_varints, 2733, play_varints, exported=True),
    Case(five_bits, 2734, play_five, exported=True),
    Case(read_commands, 2735, play_commands, exported=True),
)
