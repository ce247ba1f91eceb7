"""Codes: Gray codes, a CRC by nibbles, run lengths back to bytes."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32


@kernel
def gray_decode(gray: u16[:], binary: u16[:], parity: u8[:], n: i32) -> None:
    for i in range(n):
        b = u32(gray[i])
        shift: u32 = 8
        while shift > 0:
            b = b ^ (b >> shift)
            shift = shift >> 1
        binary[i] = b
        parity[i] = b & 1


@kernel
def crc8_nibbles(data: u8[:], n: i32, table: u8[:]) -> u32:
    crc: u32 = 0xFF
    for i in range(n):
        crc = crc ^ u32(data[i])
        crc = ((crc << 4) & 0xFF) ^ u32(table[crc >> 4])
        crc = ((crc << 4) & 0xFF) ^ u32(table[crc >> 4])
    return crc


@kernel
def rle_expand(code: u8[:], out: u8[:], room: i32) -> i32:
    i = 0
    n = 0
    while code[i] != 0:
        run = code[i]
        value = code[i + 1]
        if n + run > room:
            run = room - n
        for j in range(run):
            out[n + j] = value
        n += run
        i += 2
    return n


def play_gray(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    gray = np.array([lcg.u16() for _ in range(500)], np.uint16)
    binary, parity = np.zeros(500, np.uint16), np.zeros(500, np.uint8)
    run(gray, binary, parity, 500)
    return binary, parity


def play_crc(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    data = lcg.bytes(600)
    return (word(run(data, 600, np.array([i * 7 ^ i >> 1 for i in range(16)], np.uint8))),)


def play_expand(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    pairs = [value for _ in range(100) for value in (1 + lcg.below(15), lcg.u8())]
    out = np.zeros(1200, np.uint8)
    length = run(np.array([*pairs, 0], np.uint8), out, 1200)
    return out, word(length)


CASES = (
    Case(gray_decode, 1202, play_gray),
    Case(crc8_nibbles, 1222, play_crc),
    Case(rle_expand, 1207, play_expand),
)
