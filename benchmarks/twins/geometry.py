"""Geometry and small matrices: ellipses, the farthest point, products, crossings of segments, affine warps, means of clusters, maxima, patterns."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def draw_ellipse(picture: u8[:], stride: i32, cx: i32, cy: i32, a: i32, b: i32) -> None:
    x = -a
    y = 0
    e2 = b * b
    err = x * (2 * e2 + x) + e2
    while x <= 0:
        picture[(cy + y) * stride + cx - x] = 255
        picture[(cy + y) * stride + cx + x] = 255
        picture[(cy - y) * stride + cx + x] = 255
        picture[(cy - y) * stride + cx - x] = 255
        e2 = 2 * err
        if e2 >= (x * 2 + 1) * b * b:
            x += 1
            err += (x * 2 + 1) * b * b
        if e2 <= (y * 2 + 1) * a * a:
            y += 1
            err += (y * 2 + 1) * a * a


@kernel
def farthest_point(xs: i16[:], ys: i16[:], first: i32, last: i32) -> i32:
    x0 = xs[first]
    y0 = ys[first]
    dx = xs[last] - x0
    dy = ys[last] - y0
    best = 0
    found = first
    for i in range(first + 1, last):
        d = abs(dx * (ys[i] - y0) - dy * (xs[i] - x0))
        if d > best:
            best = d
            found = i
    return found


@kernel
def product3_q12(a: i32[:], b: i32[:], c: i32[:], count: i32) -> None:
    for m in range(count):
        o = 9 * m
        for i in range(3):
            for j in range(3):
                total = 0
                for k in range(3):
                    total += a[o + 3 * i + k] * b[3 * k + j]
                c[o + 3 * i + j] = (total + 2048) >> 12


@kernel
def side(ax: i32, ay: i32, bx: i32, by: i32, px: i32, py: i32) -> i32:
    v = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
    if v > 0:
        return 1
    return -1 if v < 0 else 0


@kernel
def segment_hits(segments: i16[:], n: i32) -> i32:
    hits = 0
    for i in range(n):
        ax = segments[4 * i]
        ay = segments[4 * i + 1]
        bx = segments[4 * i + 2]
        by = segments[4 * i + 3]
        for j in range(i + 1, n):
            cx = segments[4 * j]
            cy = segments[4 * j + 1]
            dx = segments[4 * j + 2]
            dy = segments[4 * j + 3]
            if side(ax, ay, bx, by, cx, cy) != side(ax, ay, bx, by, dx, dy):  # noqa: SIM102 - as it is often written
                if side(cx, cy, dx, dy, ax, ay) != side(cx, cy, dx, dy, bx, by):
                    hits += 1
    return hits


@kernel
def warp_nearest(src: u8[:], dst: u8[:], size: i32, m: i32[:]) -> None:
    """Warp a square picture; `m`: six numbers, 16 bits behind the point."""
    for y in range(size):
        u = m[1] * y + m[2]
        v = m[4] * y + m[5]
        for x in range(size):
            sx = u >> 16
            sy = v >> 16
            inside = 0 <= sx < size and 0 <= sy < size
            dst[y * size + x] = src[sy * size + sx] if inside else 0
            u += m[0]
            v += m[3]


@kernel
def cluster_means(values: u8[:], centres: i32[:], sums: i32[:], counts: i32[:], n: i32, k: i32) -> i32:
    for c in range(k):
        sums[c] = 0
        counts[c] = 0
    for i in range(n):
        v = values[i]
        best = 1000
        chosen = 0
        for c in range(k):
            d = abs(v - centres[c])
            if d < best:
                best = d
                chosen = c
        sums[chosen] += v
        counts[chosen] += 1
    moved = 0
    for c in range(k):
        if counts[c] > 0:
            centre = sums[c] // counts[c]
            moved += abs(centre - centres[c])
            centres[c] = centre
    return moved


@kernel
def local_maxima(score: u16[:], out: u16[:], n: i32, radius: i32, limit: i32) -> i32:
    count = 0
    for i in range(radius, n - radius):
        v = score[i]
        if v < limit:
            continue
        highest = True
        for k in range(1, radius + 1):
            if score[i - k] >= v or score[i + k] > v:
                highest = False
                break
        if highest:
            out[count] = i
            count += 1
    return count


@kernel
def hit_or_miss(picture: u8[:], out: u8[:], width: i32, height: i32) -> i32:
    """Ends of lines: pixels with a single neighbour."""
    ends = 0
    for y in range(1, height - 1):
        for x in range(1, width - 1):
            i = y * width + x
            out[i] = 0
            if picture[i] == 0:
                continue
            neighbours = 0
            for dy in range(-1, 2):
                for dx in range(-1, 2):
                    neighbours += picture[i + dy * width + dx]
            if neighbours == 2:
                out[i] = 1
                ends += 1
    return ends


@kernel
def mosaic(picture: u8[:], width: i32, height: i32, size: i32) -> None:
    for by in range(0, height - 7, 8):
        for bx in range(0, width - 7, 8):
            total = 0
            for y in range(by, by + size):
                for x in range(bx, bx + size):
                    total += picture[y * width + x]
            mean = total >> 6
            for y in range(by, by + size):
                for x in range(bx, bx + size):
                    picture[y * width + x] = mean


@kernel
def spans_of_colour(uyvy: u8[:], table: u8[:], out: u32[:], n: i32, colour: i32) -> i32:
    count = 0
    start = -1
    for x in range(n):
        y = uyvy[2 * x + 1] >> 5
        u = uyvy[4 * (x >> 1)] >> 4
        v = uyvy[4 * (x >> 1) + 2] >> 4
        match = (table[(y << 8) | (u << 4) | v] >> colour) & 1
        if match:
            if start < 0:
                start = x
        elif start >= 0:
            out[count] = u32((start << 16) | (x - start))
            count += 1
            start = -1
    return count


def play_ellipse(_: Lcg, run: Run) -> tuple[Array, ...]:
    picture = np.zeros(64 * 48, np.uint8)
    run(picture, 64, 32, 24, 28, 17)
    return (picture,)


def play_farthest(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    return (word(run(lcg.scaled(200, 320), lcg.scaled(200, 240), 3, 197)),)


def play_product(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    c = np.zeros(90, np.int32)
    run(lcg.scaled(90, 8192, -4096, "i4"), lcg.scaled(9, 8192, -4096, "i4"), c, 10)
    return (c,)


def play_hits(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    return (word(run(lcg.scaled(100, 320), 25)),)


def play_warp(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(32 * 32, np.uint8)
    m = np.array([56756, -32768, 700000, 32768, 56756, -300000], np.int32)
    run(lcg.bytes(32 * 32), dst, 32, m)
    return (dst,)


def play_clusters(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    centres = np.array([30, 90, 150, 220], np.int32)
    sums, counts = np.zeros(4, np.int32), np.zeros(4, np.int32)
    moved = run(lcg.bytes(200), centres, sums, counts, 200, 4)
    return centres, word(moved)


def play_maxima(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(100, np.uint16)
    count = run(lcg.scaled(300, 1000, 0, "u2"), out, 300, 4, 500)
    return out, word(count)


def play_ends(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture = np.array([lcg.below(4) == 0 for _ in range(32 * 20)], np.uint8)
    out = np.zeros(32 * 20, np.uint8)
    ends = run(picture, out, 32, 20)
    return out, word(ends)


def play_mosaic(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture = lcg.bytes(64 * 24)
    run(picture, 64, 24, 8)
    return (picture,)


def play_spans(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    table = np.array([lcg.below(3) for _ in range(2048)], np.uint8)
    out = np.zeros(160, np.uint32)
    count = run(lcg.bytes(80).repeat(8), table, out, 320, 0)
    return out, word(count)


CASES = (
    Case(draw_ellipse, 1851, play_ellipse, exported=True),
    Case(farthest_point, 1852, play_farthest, exported=True),
    Case(product3_q12, 1853, play_product, exported=True),
    Case(segment_hits, 1854, play_hits, exported=True),
    Case(warp_nearest, 1855, play_warp, exported=True),
    Case(cluster_means, 1856, play_clusters, exported=True),
    Case(local_maxima, 1857, play_maxima, exported=True),
    Case(hit_or_miss, 1858, play_ends, exported=True),
    Case(mosaic, 1859, play_mosaic, exported=True),
    Case(spans_of_colour, 1860, play_spans, exported=True),
)
