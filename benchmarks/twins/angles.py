"""Square roots and directions: gradient magnitude, octant tables, colour classes, radii."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def isqrt32(v: u32) -> u32:
    root: u32 = 0
    bit: u32 = 1 << 30
    for _ in range(16):
        trial = root + bit
        root = root >> 1
        if v >= trial:
            v = v - trial
            root = root + bit
        bit = bit >> 2
    return root


@kernel
def isqrt_row(gx: i16[:], gy: i16[:], mag: u16[:], n: i32):
    for i in range(n):
        x = gx[i]
        y = gy[i]
        mag[i] = i32(isqrt32(u32(x * x + y * y)))


@kernel
def direction8_row(gx: i16[:], gy: i16[:], lut: u8[:], direction: u8[:], n: i32):
    for i in range(n):
        x = gx[i]
        y = gy[i]
        ax = x
        ay = y
        angle = 0
        if ax < 0:
            ax = -ax
        if ay < 0:
            ay = -ay
        if ax != 0 or ay != 0:
            if ax >= ay:
                angle = lut[i32((u32(ay) << 8) // u32(ax))]
            else:
                angle = 64 - lut[i32((u32(ax) << 8) // u32(ay))]
            if x < 0:
                angle = 128 - angle
            if y < 0:
                angle = 256 - angle
        direction[i] = angle & 255


@kernel
def angle8(x: i32, y: i32, lut: u8[:]) -> i32:
    ax = x
    ay = y
    angle = 0
    if ax < 0:
        ax = -ax
    if ay < 0:
        ay = -ay
    if ax == 0 and ay == 0:
        return 0
    if ax >= ay:
        angle = lut[i32((u32(ay) << 8) // u32(ax))]
    else:
        angle = 64 - lut[i32((u32(ax) << 8) // u32(ay))]
    if x < 0:
        angle = 128 - angle
    if y < 0:
        angle = 256 - angle
    return angle & 255


@kernel
def colour_classify_row(uyvy: u8[:], lut: u8[:], colour: u32[:], n: i32, eps_black: i32, eps_white: i32):
    for i in range(n):
        pair = (i >> 1) * 4
        u = uyvy[pair] - 128
        v = uyvy[pair + 2] - 128
        y = uyvy[2 * i + 1]
        b = y - i32(isqrt32(u32(v * v + u * u)))
        if b < eps_black:
            cls = 1
        elif b > eps_white:
            cls = 2
        else:
            cls = angle8(v, u, lut) // 9 + 3
        colour[i] = u32(1) << u32(cls)


@kernel
def radius_hist(ex: i16[:], ey: i16[:], n: i32, cx: i32, cy: i32, hist: u16[:], nbins: i32):
    for i in range(n):
        dx = ex[i] - cx
        dy = ey[i] - cy
        r = i32(isqrt32(u32(dx * dx + dy * dy)))
        if r < nbins:
            hist[r] = hist[r] + 1


ATAN257 = np.array([math.floor(math.atan(q / 256) * 128 / math.pi + 0.5) for q in range(257)], np.uint8)


def play_isqrt(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    mag = np.zeros(320, np.uint16)
    run(lcg.scaled(320, 2041, -1020), lcg.scaled(320, 2041, -1020), mag, 320)
    return (mag,)


def play_direction(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(320, np.uint8)
    run(lcg.scaled(320, 2041, -1020), lcg.scaled(320, 2041, -1020), ATAN257, out, 320)
    return (out,)


def play_colour(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    colour = np.zeros(320, np.uint32)
    run(lcg.bytes(640), ATAN257, colour, 320, -40, 60)
    return (colour,)


def play_radius(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    points = np.array([(lcg.below(64), lcg.below(64)) for _ in range(400)], np.int16)
    hist = np.zeros(40, np.uint16)
    run(points[:, 0].copy(), points[:, 1].copy(), 400, 32, 32, hist, 40)
    return (hist,)


CASES = (
    Case(isqrt_row, 1004, play_isqrt),
    Case(direction8_row, 1006, play_direction),
    Case(colour_classify_row, 1008, play_colour),
    Case(radius_hist, 1015, play_radius),
)
