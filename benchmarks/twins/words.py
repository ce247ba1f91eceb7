"""Words and bytes as bits: reversing, interleaving, normalising, packing."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32


@kernel
def reverse_bits(src: u32[:], dst: u32[:], n: i32) -> None:
    for i in range(n):
        w = src[i]
        w = ((w >> 1) & 0x55555555) | ((w & 0x55555555) << 1)
        w = ((w >> 2) & 0x33333333) | ((w & 0x33333333) << 2)
        w = ((w >> 4) & 0x0F0F0F0F) | ((w & 0x0F0F0F0F) << 4)
        w = ((w >> 8) & 0x00FF00FF) | ((w & 0x00FF00FF) << 8)
        w = (w >> 16) | (w << 16)
        dst[i] = w


@kernel
def spread(v: u32) -> u32:
    v = (v | (v << 8)) & 0x00FF00FF
    v = (v | (v << 4)) & 0x0F0F0F0F
    v = (v | (v << 2)) & 0x33333333
    return (v | (v << 1)) & 0x55555555


@kernel
def morton(x: u16[:], y: u16[:], code: u32[:], n: i32) -> None:
    for i in range(n):
        code[i] = spread(u32(x[i])) | (spread(u32(y[i])) << 1)


@kernel
def normalise(values: u32[:], mantissa: u16[:], shift: u8[:], n: i32) -> None:
    for i in range(n):
        v = values[i]
        e = 0
        while (v & 0x80000000) == 0:
            v = v << 1
            e = e + 1
        mantissa[i] = v >> 16
        shift[i] = e


@kernel
def pack_bits(src: u8[:], dst: u8[:], n: i32, thr: i32) -> None:
    for i in range(n):
        b = 0
        for k in range(8):
            b = b << 1
            if src[i * 8 + k] > thr:
                b = b | 1
        dst[i] = b


def play_reverse(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(500, np.uint32)
    run(np.array([lcg.next() for _ in range(500)], np.uint32), dst, 500)
    return (dst,)


def play_morton(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    x, y = (np.array([lcg.u16() for _ in range(300)], np.uint16) for _ in range(2))
    code = np.zeros(300, np.uint32)
    run(x, y, code, 300)
    return (code,)


def play_normalise(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    values = np.array([lcg.next() >> (i & 31) | 1 for i in range(200)], np.uint32)
    mantissa, shift = np.zeros(200, np.uint16), np.zeros(200, np.uint8)
    run(values, mantissa, shift, 200)
    return mantissa, shift


def play_pack(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(200, np.uint8)
    run(lcg.bytes(1600), dst, 200, 100)
    return (dst,)


CASES = (
    Case(reverse_bits, 1106, play_reverse),
    Case(morton, 1108, play_morton),
    Case(normalise, 1110, play_normalise),
    Case(pack_bits, 1112, play_pack),
)
