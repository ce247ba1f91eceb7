"""Sums of pictures: a threshold by the mean around, co-occurrence, projections, a centre of mass, a histogram's stretch."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32


@kernel
def local_threshold(
    picture: u8[:], sums: u32[:], out: u8[:], w: i32, h: i32, reach: i32, offset: i32
) -> None:
    pitch = w + 1
    for y in range(h):
        top = max(y - reach, 0)
        bottom = min(y + reach + 1, h)
        for x in range(w):
            left = max(x - reach, 0)
            right = min(x + reach + 1, w)
            area = (bottom - top) * (right - left)
            total = (
                sums[bottom * pitch + right]
                - sums[top * pitch + right]
                - sums[bottom * pitch + left]
                + sums[top * pitch + left]
            )
            if (picture[y * w + x] + offset) * area < i32(total):
                out[y * w + x] = 255
            else:
                out[y * w + x] = 0


@kernel
def cooccurrence(picture: u8[:], table: u16[:], w: i32, h: i32, shift: i32) -> None:
    for y in range(h):
        for x in range(w - 1):
            a = picture[y * w + x] >> shift
            b = picture[y * w + x + 1] >> shift
            table[(a << 3) + b] += 1
            table[(b << 3) + a] += 1


@kernel
def centre_of_mass(picture: u8[:], w: i32, h: i32, level: i32, found: i32[:]) -> None:
    mass = 0
    sx = 0
    sy = 0
    for y in range(h):
        row = 0
        for x in range(w):
            value = picture[y * w + x]
            if value >= level:
                row += value
                sx += value * x
        mass += row
        sy += row * y
    found[0] = mass
    if mass > 0:
        found[1] = (sx << 4) // mass
        found[2] = (sy << 4) // mass


@kernel
def stretch_limits(histogram: u16[:], total: i32, found: u8[:]) -> None:
    clip = total // 50
    low = 0
    seen = histogram[0]
    while seen < clip and low < 255:
        low += 1
        seen += histogram[low]
    high = 255
    seen = histogram[255]
    while seen < clip and high > low:
        high -= 1
        seen += histogram[high]
    found[0] = low
    found[1] = high


@kernel
def absolute_gradients(picture: u8[:], histogram: u16[:], w: i32, h: i32) -> i32:
    largest = 0
    for y in range(1, h - 1):
        above = (y - 1) * w
        below = (y + 1) * w
        here = y * w
        for x in range(1, w - 1):
            gx = picture[here + x + 1] - picture[here + x - 1]
            gy = picture[below + x] - picture[above + x]
            size = abs(gx) + abs(gy)
            if size > 255:
                size = 255
            histogram[size] += 1
            if size > largest:
                largest = size
    return largest


def play_threshold(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture = lcg.bytes(28 * 20).reshape(20, 28)
    sums = np.zeros((21, 29), np.uint32)
    sums[1:, 1:] = picture.cumsum(0, dtype=np.uint32).cumsum(1, dtype=np.uint32)
    out = np.zeros(28 * 20, np.uint8)
    run(picture.ravel(), sums.ravel(), out, 28, 20, 3, 10)
    return (out,)


def play_cooccurrence(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    table = np.zeros(64, np.uint16)
    run(lcg.bytes(40 * 25), table, 40, 25, 5)
    return (table,)


def play_centre(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    found = np.zeros(3, np.int32)
    run(lcg.bytes(40 * 30), 40, 30, 128, found)
    return (found,)


def play_limits(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    histogram = np.bincount(80 + lcg.scaled(4000, 60, 0, "i4") + lcg.scaled(4000, 60, 0, "i4"), minlength=256)
    found = np.zeros(2, np.uint8)
    run(histogram.astype(np.uint16), 4000, found)
    return (found,)


def play_gradients(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    histogram = np.zeros(256, np.uint16)
    largest = run(lcg.bytes(36 * 22), histogram, 36, 22)
    return histogram, word(largest)


CASES = (
    Case(local_threshold, 2221, play_threshold, exported=True),
    Case(cooccurrence, 2222, play_cooccurrence, exported=True),
    Case(centre_of_mass, 2223, play_centre, exported=True),
    Case(stretch_limits, 2224, play_limits, exported=True),
    Case(absolute_gradients, 2225, play_gradients, exported=True),
)
