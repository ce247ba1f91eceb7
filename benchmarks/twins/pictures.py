"""Whole pictures: transposed, smoothed, edges, sums of windows, contrast."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16


@kernel
def transpose_u8(src: u8[:], dst: u8[:], w: i32, h: i32) -> None:
    for y in range(h):
        for x in range(w):
            dst[x * h + y] = src[y * w + x]


@kernel
def box3x3(src: u8[:], dst: u8[:], w: i32, h: i32) -> None:
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            total = 0
            for v in range(-1, 2):
                p = (y + v) * w + x
                total += src[p - 1] + src[p] + src[p + 1]
            dst[y * w + x] = (total * 7282) >> 16


@kernel
def sobel_binary(src: u8[:], dst: u8[:], w: i32, h: i32, threshold: i32) -> i32:
    edges = 0
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            p = y * w + x
            gx = (
                src[p - w + 1]
                - src[p - w - 1]
                + 2 * (src[p + 1] - src[p - 1])
                + src[p + w + 1]
                - src[p + w - 1]
            )
            gy = (
                src[p + w - 1]
                + 2 * src[p + w]
                + src[p + w + 1]
                - src[p - w - 1]
                - 2 * src[p - w]
                - src[p - w + 1]
            )
            if gx < 0:
                gx = -gx
            if gy < 0:
                gy = -gy
            if gx + gy >= threshold:
                dst[p] = 255
                edges += 1
            else:
                dst[p] = 0
    return edges


@kernel
def stretch(image: u8[:], n: i32, histogram: u16[:], table: u8[:], cut: i32) -> None:
    for i in range(256):
        histogram[i] = 0
    for i in range(n):
        histogram[image[i]] += 1
    low = 0
    total = histogram[0]
    while total < cut:
        low += 1
        total += histogram[low]
    high = 255
    total = histogram[255]
    while total < cut:
        high -= 1
        total += histogram[high]
    width = high - low
    scale = (255 << 8) // (width if width > 0 else 1)
    for i in range(256):
        v = ((i - low) * scale) >> 8
        if v < 0:
            v = 0
        if v > 255:
            v = 255
        table[i] = v
    for i in range(n):
        image[i] = table[image[i]]


@kernel
def window_sums(src: u8[:], column: u16[:], dst: u16[:], w: i32, h: i32, size: i32) -> None:
    for x in range(w):
        column[x] = 0
    for y in range(h):
        for x in range(w):
            column[x] += src[y * w + x]
            if y >= size:
                column[x] -= src[(y - size) * w + x]
        if y >= size - 1:
            total = 0
            for x in range(w):
                total += column[x]
                if x >= size:
                    total -= column[x - size]
                dst[y * w + x] = total


@kernel
def laplace_abs(src: u8[:], dst: u8[:], w: i32, h: i32, gain: i32) -> i32:
    cut = 0
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            p = y * w + x
            d = 4 * src[p] - src[p - 1] - src[p + 1] - src[p - w] - src[p + w]
            if d < 0:
                d = -d
            d = d * gain
            if d > 255:
                dst[p] = 255
                cut += 1
            else:
                dst[p] = d
    return cut


@kernel
def column_means(src: u8[:], sums: u16[:], dst: u8[:], w: i32, h: i32, shift: i32) -> None:
    rows = 1 << shift
    for y in range(h):
        for x in range(w):
            sums[x] += src[y * w + x]
            if y >= rows:
                sums[x] -= src[(y - rows) * w + x]
                dst[y * w + x] = sums[x] >> shift


def play_transpose(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(48 * 32, np.uint8)
    run(lcg.bytes(48 * 32), dst, 48, 32)
    return (dst,)


def play_box(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(40 * 24, np.uint8)
    run(lcg.bytes(40 * 24), dst, 40, 24)
    return (dst,)


def play_sobel(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(48 * 20, np.uint8)
    edges = run(lcg.bytes(48 * 20), dst, 48, 20, 300)
    return dst, word(edges)


def play_stretch(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image = np.array([60 + lcg.below(50) + lcg.below(60) for _ in range(1500)], np.uint8)
    run(image, 1500, np.zeros(256, np.uint16), np.zeros(256, np.uint8), 40)
    return (image,)


def play_laplace(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(40 * 20, np.uint8)
    cut = run(lcg.bytes(40 * 20), dst, 40, 20, 1)
    return dst, word(cut)


def play_columns(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(50 * 16, np.uint8)
    run(lcg.bytes(50 * 16), np.zeros(50, np.uint16), dst, 50, 16, 2)
    return (dst,)


def play_windows(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(60 * 16, np.uint16)
    run(lcg.bytes(60 * 16), np.zeros(60, np.uint16), dst, 60, 16, 5)
    return (dst,)


CASES = (
    Case(transpose_u8, 1203, play_transpose),
    Case(box3x3, 1205, play_box),
    Case(sobel_binary, 1225, play_sobel),
    Case(laplace_abs, 1245, play_laplace),
    Case(column_means, 1242, play_columns),
    Case(stretch, 1227, play_stretch),
    Case(window_sums, 1228, play_windows),
)
