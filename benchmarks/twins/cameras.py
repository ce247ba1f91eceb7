"""Rows of a camera: census transform, green of a Bayer pattern, packed colours to grey, two thresholds, disparities."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16


@kernel
def census_row(above: u8[:], here: u8[:], below: u8[:], out: u8[:], n: i32) -> None:
    for x in range(1, n - 1):
        centre = here[x]
        code = 0
        for k in range(-1, 2):
            code = (code << 1) | (1 if above[x + k] < centre else 0)
        code = (code << 1) | (1 if here[x - 1] < centre else 0)
        code = (code << 1) | (1 if here[x + 1] < centre else 0)
        for k in range(-1, 2):
            code = (code << 1) | (1 if below[x + k] < centre else 0)
        out[x] = code


@kernel
def bayer_green_row(above: u8[:], here: u8[:], below: u8[:], green: u8[:], n: i32, odd: i32) -> None:
    for x in range(1, n - 1):
        if ((x ^ odd) & 1) != 0:
            green[x] = here[x]
        else:
            across = abs(here[x - 1] - here[x + 1])
            down = abs(above[x] - below[x])
            if across < down:
                green[x] = (here[x - 1] + here[x + 1] + 1) >> 1
            elif down < across:
                green[x] = (above[x] + below[x] + 1) >> 1
            else:
                green[x] = (here[x - 1] + here[x + 1] + above[x] + below[x] + 2) >> 2


@kernel
def grey_of_565(pixels: u16[:], grey: u8[:], n: i32) -> i32:
    brightest = 0
    for x in range(n):
        p = pixels[x]
        red = (p >> 11) << 3
        green = ((p >> 5) & 63) << 2
        blue = (p & 31) << 3
        y = (77 * red + 150 * green + 29 * blue) >> 8
        grey[x] = y
        brightest = max(brightest, y)
    return brightest


@kernel
def two_thresholds(row: u8[:], low: i32, high: i32, out: u8[:], n: i32) -> i32:
    on = 0
    starts = 0
    for x in range(n):
        value = row[x]
        if on != 0:
            if value < low:
                on = 0
        elif value >= high:
            on = 1
            starts += 1
        out[x] = on
    return starts


@kernel
def disparity_row(left: u8[:], right: u8[:], out: u8[:], n: i32, most: i32) -> None:
    for x in range(most + 2, n - 2):
        best = 32767
        second = 32767
        found = 0
        for d in range(most):
            cost = 0
            for k in range(-2, 3):
                cost += abs(left[x + k] - right[x + k - d])
            if cost < best:
                second = best
                best = cost
                found = d
            elif cost < second:
                second = cost
        out[x] = found if best * 5 < second * 4 else 255


def play_three(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(200, np.uint8)
    run(lcg.bytes(200), lcg.bytes(200), lcg.bytes(200), out, 200)
    return (out,)


def play_bayer(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    rows = [lcg.bytes(240) for _ in range(3)]
    outs = [np.zeros(240, np.uint8) for _ in range(2)]
    for odd, out in enumerate(outs):
        run(*rows, out, 240, odd)
    return tuple(outs)


def play_grey(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    pixels = np.array([lcg.u16() for _ in range(300)], np.uint16)
    grey = np.zeros(300, np.uint8)
    brightest = run(pixels, grey, 300)
    return grey, word(brightest)


def play_thresholds(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    row = (np.convolve(lcg.bytes(507), np.ones(8), "valid") / 8).astype(np.uint8)
    out = np.zeros(500, np.uint8)
    starts = run(row, 110, 150, out, 500)
    return out, word(starts)


def play_disparity(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    right = lcg.bytes(100)
    left = np.roll(right, 5)
    left[::7] += 20
    out = np.zeros(100, np.uint8)
    run(left, right, out, 100, 12)
    return (out,)


CASES = (
    Case(census_row, 2021, play_three, exported=True),
    Case(bayer_green_row, 2022, play_bayer, exported=True),
    Case(grey_of_565, 2023, play_grey, exported=True),
    Case(two_thresholds, 2024, play_thresholds, exported=True),
    Case(disparity_row, 2025, play_disparity, exported=True),
)
