"""Look-ups: chained tables, histogram equalisation, CRC by table, interpolation between pixels."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32


@kernel
def lut_chain(src: u8[:], tone: u8[:], cls: u8[:], dst: u8[:], n: i32) -> None:
    for i in range(n):
        dst[i] = cls[tone[src[i]]]


@kernel
def equalise(src: u8[:], dst: u8[:], hist: u16[:], lut: u8[:], n: i32) -> None:
    total: u32 = 0
    for i in range(256):
        hist[i] = 0
    for i in range(n):
        hist[src[i]] = hist[src[i]] + 1
    for i in range(256):
        total += u32(hist[i])
        lut[i] = total * 255 // u32(n)
    for i in range(n):
        dst[i] = lut[src[i]]


@kernel
def crc32_table(data: u8[:], n: i32, table: u32[:]) -> u32:
    crc: u32 = 0xFFFFFFFF
    for i in range(n):
        crc = table[(crc ^ u32(data[i])) & 255] ^ (crc >> 8)
    return ~crc


@kernel
def bilinear_row(src: u8[:], w: i32, xs: u16[:], ys: u16[:], dst: u8[:], n: i32) -> None:
    for i in range(n):
        fx = xs[i] & 255
        fy = ys[i] & 255
        p = (ys[i] >> 8) * w + (xs[i] >> 8)
        top = src[p] * (256 - fx) + src[p + 1] * fx
        bottom = src[p + w] * (256 - fx) + src[p + w + 1] * fx
        dst[i] = (top * (256 - fy) + bottom * fy + 32768) >> 16


def crc_table() -> Array:
    """CRC-32 of every byte, least significant bit first."""
    table = np.arange(256, dtype=np.uint32)
    for _ in range(8):
        table = np.where(table & 1, table >> 1 ^ 0xEDB88320, table >> 1).astype(np.uint32)
    return table


def play_chain(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(2000, np.uint8)
    run(lcg.bytes(2000), lcg.bytes(256), lcg.bytes(256), dst, 2000)
    return (dst,)


def play_equalise(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst, hist, lut = np.zeros(1024, np.uint8), np.zeros(256, np.uint16), np.zeros(256, np.uint8)
    run(lcg.scaled(1024, 128, 30, "u1"), dst, hist, lut, 1024)
    return dst, hist


def play_crc(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    return (np.array([run(lcg.bytes(1500), 1500, crc_table())], np.uint32),)


def play_bilinear(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(320, np.uint8)
    src = lcg.bytes(64 * 48)
    run(src, 64, lcg.scaled(320, 63 * 256, kind="u2"), lcg.scaled(320, 47 * 256, kind="u2"), dst, 320)
    return (dst,)


CASES = (
    Case(lut_chain, 1101, play_chain),
    Case(equalise, 1103, play_equalise),
    Case(crc32_table, 1105, play_crc),
    Case(bilinear_row, 1107, play_bilinear),
)
