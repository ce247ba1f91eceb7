"""Warps: a rotation by the nearest pixel, a row undistorted by its map, a picture doubled, polar rows, a colour chosen."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def rotate_picture(source: u8[:], out: u8[:], w: i32, h: i32, cosine: i32, sine: i32) -> None:
    for y in range(h):
        u = (w << 15) - cosine * (w >> 1) + sine * ((h >> 1) - y)
        v = (h << 15) - sine * (w >> 1) - cosine * ((h >> 1) - y)
        for x in range(w):
            sx = u >> 16
            sy = v >> 16
            if 0 <= sx < w and 0 <= sy < h:
                out[y * w + x] = source[sy * w + sx]
            else:
                out[y * w + x] = 0
            u += cosine
            v += sine


@kernel
def between(a: i32, b: i32, part: i32) -> i32:
    return a + (((b - a) * part + 8) >> 4)


@kernel
def undistort_row(source: u8[:], w: i32, places: u16[:], parts: u8[:], out: u8[:], n: i32) -> None:
    for i in range(n):
        at = places[i]
        px = parts[i] & 15
        py = parts[i] >> 4
        top = between(source[at], source[at + 1], px)
        bottom = between(source[at + w], source[at + w + 1], px)
        out[i] = between(top, bottom, py)


@kernel
def double_picture(source: u8[:], out: u8[:], w: i32, h: i32) -> None:
    wide = 2 * w
    for y in range(h - 1):
        for x in range(w - 1):
            a = source[y * w + x]
            b = source[y * w + x + 1]
            c = source[(y + 1) * w + x]
            d = source[(y + 1) * w + x + 1]
            at = 2 * y * wide + 2 * x
            out[at] = a
            out[at + 1] = (a + b + 1) >> 1
            out[at + wide] = (a + c + 1) >> 1
            out[at + wide + 1] = (a + b + c + d + 2) >> 2


@kernel
def polar_rows(source: u8[:], w: i32, cx: i32, cy: i32, sines: i16[:], out: u8[:], radii: i32) -> None:
    for angle in range(64):
        sine = sines[angle]
        cosine = sines[(angle + 16) & 63]
        for r in range(radii):
            x = cx + ((r * cosine + 8192) >> 14)
            y = cy + ((r * sine + 8192) >> 14)
            out[angle * radii + r] = source[y * w + x]


@kernel
def choose_colour(pixels: u16[:], n: i32, classes: u8[:], counts: i32[:]) -> None:
    for i in range(n):
        p = pixels[i]
        r = (p >> 11) << 1
        g = (p >> 5) & 63
        b = (p & 31) << 1
        high = max(r, g)
        high = max(high, b)
        low = min(r, g)
        low = min(low, b)
        kind = 0
        if high - low < 8:
            kind = 1 if high > 40 else 0
        elif high == r:
            kind = 2 if g < b + 10 else 3
        elif high == g:
            kind = 4
        else:
            kind = 5
        classes[i] = kind
        counts[kind] += 1


def play_rotation(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(28 * 24, np.uint8)
    run(lcg.bytes(28 * 24), out, 28, 24, 59000, 28000)
    return (out,)


def play_undistort(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(200, np.uint8)
    run(lcg.bytes(800), 100, lcg.scaled(200, 690, 0, "u2"), lcg.bytes(200), out, 200)
    return (out,)


def play_double(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(4 * 24 * 18, np.uint8)
    run(lcg.bytes(24 * 18), out, 24, 18)
    return (out,)


def play_polar(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    sines = np.round(np.sin(np.arange(64) * np.pi / 32) * 16384).astype(np.int16)
    out = np.zeros(64 * 14, np.uint8)
    run(lcg.bytes(32 * 32), 32, 16, 15, sines, out, 14)
    return (out,)


def play_colours(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    pixels = np.array([lcg.u16() for _ in range(300)], np.uint16)
    classes, counts = np.zeros(300, np.uint8), np.zeros(6, np.int32)
    run(pixels, 300, classes, counts)
    return classes, counts


CASES = (
    Case(rotate_picture, 2331, play_rotation, exported=True),
    Case(undistort_row, 2332, play_undistort, exported=True),
    Case(double_picture, 2333, play_double, exported=True),
    Case(polar_rows, 2334, play_polar, exported=True),
    Case(choose_colour, 2335, play_colours, exported=True),
)
