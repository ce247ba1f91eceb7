"""Tallies and tables: radix sort, Gray codes and parities, a contrast table, CRC-16, counted islands."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, quotient, u8, u16, u32


@kernel
def radix_sort(a: u16[:], b: u16[:], count: i32[:], n: i32) -> None:
    for shift in range(0, 16, 8):
        for i in range(256):
            count[i] = 0
        for i in range(n):
            count[(a[i] >> shift) & 255] += 1
        total = 0
        for i in range(256):
            c = count[i]
            count[i] = total
            total += c
        for i in range(n):
            d = (a[i] >> shift) & 255
            b[count[d]] = a[i]
            count[d] += 1
        for i in range(n):
            a[i] = b[i]


@kernel
def gray_parity(src: u16[:], n: i32, gray: u16[:], highest: u8[:]) -> i32:
    odd = 0
    for i in range(n):
        v = u32(src[i])
        g = v ^ (v >> 1)
        gray[i] = g
        p = g ^ (g >> 8)
        p ^= p >> 4
        p ^= p >> 2
        p ^= p >> 1
        odd += i32(p & 1)
        k = 0
        while v > 1:
            v >>= 1
            k += 1
        highest[i] = k
    return odd


@kernel
def contrast_lut(image: u8[:], n: i32, gain: i32, offset: i32, lut: u8[:]) -> i32:
    for i in range(256):
        v = (((i - 128) * gain) >> 6) + 128 + offset
        if v < 0:
            v = 0
        if v > 255:
            v = 255
        lut[i] = v
    cut = 0
    for i in range(n):
        v = lut[image[i]]
        if v == 0 or v == 255:
            cut += 1
        image[i] = v
    return cut


@kernel
def crc16_table(data: u8[:], n: i32, table: u16[:]) -> u32:
    crc: u32 = 0xFFFF
    for i in range(n):
        crc = ((crc << 8) & 0xFFFF) ^ u32(table[((crc >> 8) ^ u32(data[i])) & 255])
    return crc


@kernel
def count_islands(image: u8[:], w: i32, h: i32, stack: i16[:], size: i32[:]) -> i32:
    islands = 0
    largest = 0
    for start in range(w * h):
        if image[start] != 1:
            continue
        top = 0
        pixels = 0
        stack[top] = start
        top += 1
        image[start] = 2
        while top > 0:
            top -= 1
            p = stack[top]
            y = quotient(p, w)  # as the C divides
            x = p - y * w
            pixels += 1
            for dy in range(-1, 2):
                for dx in range(-1, 2):
                    if x + dx < 0 or x + dx >= w or y + dy < 0 or y + dy >= h:
                        continue
                    q = p + dy * w + dx
                    if image[q] == 1:
                        image[q] = 2
                        stack[top] = q
                        top += 1
        islands += 1
        if pixels > largest:
            largest = pixels
    size[0] = largest
    return islands


def play_radix(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = np.array([lcg.u16() for _ in range(200)], np.uint16)
    run(a, np.zeros(200, np.uint16), np.zeros(256, np.int32), 200)
    return (a,)


def play_gray(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    src = np.array([lcg.u16() for _ in range(250)], np.uint16)
    gray, highest = np.zeros(250, np.uint16), np.zeros(250, np.uint8)
    odd = run(src, 250, gray, highest)
    return gray, highest, word(odd)


def play_contrast(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image = lcg.bytes(600)
    cut = run(image, 600, 96, 10, np.zeros(256, np.uint8))
    return image, word(cut)


def play_crc(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    data, table = lcg.bytes(700), np.array([lcg.u16() for _ in range(256)], np.uint16)
    return (np.array([run(data, 700, table)], np.uint32),)


def play_islands(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image, size = np.array([lcg.u8() < 80 for _ in range(24 * 18)], np.uint8), np.zeros(1, np.int32)
    islands = run(image, 24, 18, np.zeros(24 * 18, np.int16), size)
    return image, size, word(islands)


CASES = (
    Case(radix_sort, 1401, play_radix),
    Case(gray_parity, 1405, play_gray),
    Case(contrast_lut, 1409, play_contrast),
    Case(crc16_table, 1410, play_crc),
    Case(count_islands, 1404, play_islands),
)
