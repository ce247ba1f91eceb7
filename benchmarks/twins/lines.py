"""Lines and circles: votes, growing segments, border parameters, matching."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def circle_vote(ex: i16[:], ey: i16[:], edir: u8[:], n: i32, slope: i16[:], acc: u16[:], p: i32):
    for e in range(n):
        x = ex[e]
        y = ey[e]
        d = edir[e]
        step = slope[d]
        if ((d + 32) & 127) < 64:
            f = y * 256 + 128 - x * step
            for i in range(p):
                r = f >> 8
                if r >= 0 and r < p:
                    k = r * p + i
                    acc[k] = acc[k] + 1
                f = f + step
        else:
            f = x * 256 + 128 - y * step
            for i in range(p):
                c = f >> 8
                if c >= 0 and c < p:
                    k = i * p + c
                    acc[k] = acc[k] + 1
                f = f + step


@kernel
def grow_segments(
    ex: i16[:], edir: u8[:], n: i32, y: i32, thr: i32,
    lx: i16[:], ly: i16[:], ldir: u16[:], lcount: u16[:], nlines: i32, max_lines: i32,
) -> i32:  # fmt: skip
    for i in range(n):
        x = ex[i]
        d = edir[i]
        found = 0
        j = 0
        while j < nlines and found == 0:
            dx = x - lx[j]
            if dx >= -1 and dx <= 1:
                diff = (d - (ldir[j] >> 8)) & 255
                if diff >= 128:
                    diff = diff - 256
                adiff = diff
                if adiff < 0:
                    adiff = -adiff
                if adiff < thr:
                    c = lcount[j] + 1
                    q = (adiff * 256) // c
                    if diff < 0:
                        q = -q
                    lx[j] = x
                    ly[j] = y
                    lcount[j] = c
                    ldir[j] = (ldir[j] + q) & 65535
                    found = 1
            j = j + 1
        if found == 0 and nlines < max_lines:
            lx[nlines] = x
            ly[nlines] = y
            ldir[nlines] = d * 256
            lcount[nlines] = 1
            nlines = nlines + 1
    return nlines


@kernel
def div_trunc(a: i32, b: i32) -> i32:
    neg = 0
    if a < 0:
        a = -a
        neg = 1
    if b < 0:
        b = -b
        neg = 1 - neg
    q = i32(u32(a) // u32(b))
    if neg != 0:
        q = -q
    return q


@kernel
def muff_params(
    x0: i16[:], y0: i16[:], x1: i16[:], y1: i16[:], n: i32, w: i32, h: i32, s1: i32[:], s2: i32[:],
):  # fmt: skip
    wm = w - 1
    hm = h - 1
    for i in range(n):
        ax = x0[i]
        ay = y0[i]
        dx = x1[i] - ax
        dy = y1[i] - ay
        a = -1
        b = -1
        if dx != 0:
            p = ay - div_trunc(ax * dy, dx)
            if p >= 0 and p <= hm:
                a = 2 * wm + hm + (hm - p)
            p = ay + div_trunc((wm - ax) * dy, dx)
            if p >= 0 and p <= hm:
                if a < 0:
                    a = wm + p
                else:
                    b = wm + p
        if dy != 0:
            p = ax - div_trunc(ay * dx, dy)
            if p > 0 and p < wm:
                if a < 0:
                    a = p
                elif b < 0:
                    b = p
            p = ax + div_trunc((hm - ay) * dx, dy)
            if p > 0 and p < wm:
                if a < 0:
                    a = wm + hm + (wm - p)
                elif b < 0:
                    b = wm + hm + (wm - p)
        s1[i] = a
        s2[i] = b


@kernel
def match_lines(
    ax: i16[:], ay: i16[:], aa: u8[:], n: i32,
    bx: i16[:], by: i16[:], ba: u8[:], m: i32,
    thr: i32, max_d2: i32, match: i16[:],
) -> i32:  # fmt: skip
    count = 0
    for i in range(n):
        x = ax[i]
        y = ay[i]
        a = aa[i]
        best = -1
        best_d2 = max_d2
        for j in range(m):
            diff = (a - ba[j]) & 127
            if diff > 64:
                diff = 128 - diff
            if diff < thr:
                dx = x - bx[j]
                dy = y - by[j]
                d2 = dx * dx + dy * dy
                if d2 < best_d2:
                    best_d2 = d2
                    best = j
        match[i] = best
        if best >= 0:
            count = count + 1
    return count


def slope_table() -> Array:
    """Slopes in 8.8 of the 256 directions, of the flatter axis."""
    slopes = []
    for d in range(256):
        t = 2 * math.pi * d / 256
        flat = ((d + 32) & 127) < 64
        slopes.append(math.floor(256 * (math.tan(t) if flat else math.cos(t) / math.sin(t)) + 0.5))
    return np.array(slopes, np.int16)


def columns(rows: list[tuple[int, ...]], *kinds: str) -> list[Array]:
    """Turn rows of draws into arrays."""
    return [np.array(column, kind) for column, kind in zip(zip(*rows, strict=True), kinds, strict=True)]


def play_circle(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    edges = columns([(lcg.below(40), lcg.below(40), lcg.u8()) for _ in range(100)], "i2", "i2", "u1")
    acc = np.zeros(1600, np.uint16)
    run(*edges, 100, slope_table(), acc, 40)
    return (acc,)


def play_grow(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    lx, ly = np.zeros(96, np.int16), np.zeros(96, np.int16)
    ldir, lcount = np.zeros(96, np.uint16), np.zeros(96, np.uint16)
    for i in range(64):
        lx[i], ly[i], ldir[i], lcount[i] = lcg.below(320), 16, lcg.u8() * 256, 1 + lcg.below(20)
    edges = []
    for i in range(64):
        a, b = lcg.below(320), lcg.u8()
        follows = (int(lx[i]) + a % 3 - 1, ((int(ldir[i]) >> 8) + (b & 15) - 7) & 255)
        edges.append(follows if i % 2 == 0 else (a, b))
    nlines = run(*columns(edges, "i2", "u1"), 64, 17, 12, lx, ly, ldir, lcount, 64, 96)
    return lx, ly, ldir, lcount, word(nlines)


def play_muff(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    rows = [(lcg.below(320), lcg.below(240), lcg.below(320), lcg.below(240)) for _ in range(256)]
    s1, s2 = np.zeros(256, np.int32), np.zeros(256, np.int32)
    run(*columns(rows, "i2", "i2", "i2", "i2"), 256, 320, 240, s1, s2)
    return s1, s2


def play_match(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    sets = [[(lcg.below(320), lcg.below(240), lcg.u8()) for _ in range(60)] for _ in range(2)]
    first, second = (columns(rows, "i2", "i2", "u1") for rows in sets)
    matches = np.zeros(60, np.int16)
    count = run(*first, 60, *second, 60, 16, 2500, matches)
    return matches, word(count)


CASES = (
    Case(circle_vote, 1014, play_circle),
    Case(grow_segments, 1016, play_grow),
    Case(muff_params, 1017, play_muff),
    Case(match_lines, 1020, play_match),
)
