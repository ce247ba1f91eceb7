"""Figures and numbers: triangles, the nearest segment, powers of two, reciprocals, a sorting network."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def side_of(ax: i32, ay: i32, bx: i32, by: i32, x: i32, y: i32) -> i32:
    return (bx - ax) * (y - ay) - (by - ay) * (x - ax)


@kernel
def fill_triangle(image: u8[:], stride: i32, corners: i16[:], colour: i32) -> i32:
    x0 = i32(corners[0])
    y0 = i32(corners[1])
    x1 = i32(corners[2])
    y1 = i32(corners[3])
    x2 = i32(corners[4])
    y2 = i32(corners[5])
    left = min(x1, x2)
    right = max(x1, x2)
    top = min(y1, y2)
    bottom = max(y1, y2)
    left = min(left, x0)
    right = max(right, x0)
    top = min(top, y0)
    bottom = max(bottom, y0)
    pixels = 0
    for y in range(top, bottom + 1):
        e0 = side_of(x0, y0, x1, y1, left, y)
        e1 = side_of(x1, y1, x2, y2, left, y)
        e2 = side_of(x2, y2, x0, y0, left, y)
        for x in range(left, right + 1):
            if e0 >= 0 and e1 >= 0 and e2 >= 0:
                image[y * stride + x] = colour
                pixels += 1
            e0 -= y1 - y0
            e1 -= y2 - y1
            e2 -= y0 - y2
    return pixels


@kernel
def nearest_segment(segments: i16[:], count: i32, x: i32, y: i32, found: i32[:]) -> i32:
    best = 0x7FFFFFFF
    which = -1
    for s in range(count):
        ax = segments[4 * s]
        ay = segments[4 * s + 1]
        dx = segments[4 * s + 2] - ax
        dy = segments[4 * s + 3] - ay
        px = x - ax
        py = y - ay
        along = px * dx + py * dy
        length = dx * dx + dy * dy
        if along <= 0 or length == 0:
            d = px * px + py * py
        elif along >= length:
            d = (px - dx) * (px - dx) + (py - dy) * (py - dy)
        else:
            t = (along << 8) // length
            ex = (px << 8) - t * dx
            ey = (py << 8) - t * dy
            d = ((ex >> 6) * (ex >> 6) + (ey >> 6) * (ey >> 6)) >> 4
        if d < best:
            best = d
            which = s
    found[0] = which
    return best


@kernel
def exp2_row(x: i32[:], out: u32[:], n: i32) -> None:
    """Powers of two of numbers with 12 fractional bits, by a polynomial; 16 fractional bits."""
    for i in range(n):
        whole = x[i] >> 12
        f = x[i] & 0xFFF
        p = 920
        p = ((p * f) >> 12) + 3600
        p = ((p * f) >> 12) + 15750
        p = ((p * f) >> 12) + 45426
        y = u32(((p * f) >> 12) + 65536)
        if whole >= 0:
            out[i] = y << u32(min(whole, 14))
        else:
            out[i] = y >> u32(min(-whole, 31))


@kernel
def reciprocal_row(values: u16[:], n: i32, out: u16[:]) -> None:
    for i in range(n):
        v = u32(values[i])
        if v == 0:
            out[i] = 0xFFFF
            continue
        shift: u32 = 0
        while v < 0x8000:
            v = v << 1
            shift += 1
        r: u32 = 48 * 1024 - (v >> 1)
        for _ in range(2):
            e = (r * v) >> 15
            r = (r * (0x10000 - (e >> 1))) >> 15
            r = r & 0xFFFF
        out[i] = r >> u32(max(15 - i32(shift), 0))


@kernel
def bitonic_sort(a: u16[:], log_n: i32) -> None:
    n = 1 << log_n
    k = 2
    while k <= n:
        j = k >> 1
        while j > 0:
            for i in range(n):
                partner = i ^ j
                if partner > i:
                    x = a[i]
                    y = a[partner]
                    if ((i & k) == 0 and x > y) or ((i & k) != 0 and x < y):
                        a[i] = y
                        a[partner] = x
            j = j >> 1
        k = k << 1


def play_triangle(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image, pixels = np.zeros(40 * 40, np.uint8), []
    for number in range(4):
        x0, y0, x1, y1, x2, y2 = lcg.scaled(6, 40).tolist()
        if (x1 - x0) * (y2 - y0) < (y1 - y0) * (x2 - x0):
            x1, y1, x2, y2 = x2, y2, x1, y1
        pixels.append(run(image, 40, np.array([x0, y0, x1, y1, x2, y2], np.int16), number + 1))
    return image, np.array(pixels, np.int32)


def play_nearest(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    segments, found, best = lcg.scaled(160, 320), np.zeros(1, np.int32), []
    for _ in range(3):
        best.append(run(segments, 40, lcg.below(320), lcg.below(240), found))
    return found, np.array(best, np.int32)


def play_exp2(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(150, np.uint32)
    run(lcg.scaled(150, 60000, -30000, "i4"), out, 150)
    return (out,)


def play_reciprocal(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(100, np.uint16)
    run(np.array([lcg.u16() >> lcg.below(12) for _ in range(100)], np.uint16), 100, out)
    return (out,)


def play_bitonic(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = lcg.scaled(64, 60000, 0, "u2")
    run(a, 6)
    return (a,)


CASES = (
    Case(fill_triangle, 2741, play_triangle, exported=True),
    Case(nearest_segment, 2742, play_nearest, exported=True),
    Case(exp2_row, 2743, play_exp2, exported=True),
    Case(reciprocal_row, 2744, play_reciprocal, exported=True),
    Case(bitonic_sort, 2745, play_bitonic, exported=True),
)
