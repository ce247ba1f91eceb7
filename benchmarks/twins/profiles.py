"""Rows of a picture as profiles: crossings of zero, scores of corners, peaks between pixels, pairs of edges."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def zero_crossings(row: i16[:], n: i32, least: i32, places: u16[:]) -> i32:
    found = 0
    for x in range(1, n):
        before = row[x - 1]
        here = row[x]
        if (before ^ here) < 0 and abs(here - before) >= least:
            places[found] = x
            found += 1
    return found


@kernel
def corner_scores(ix: i16[:], iy: i16[:], w: i32, h: i32, scores: i32[:]) -> i32:
    best = 0
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            xx = 0
            yy = 0
            xy = 0
            for dy in range(-1, 2):
                for dx in range(-1, 2):
                    at = (y + dy) * w + x + dx
                    xx += ix[at] * ix[at]
                    yy += iy[at] * iy[at]
                    xy += ix[at] * iy[at]
            xx >>= 6
            yy >>= 6
            xy >>= 6
            trace = xx + yy
            score = xx * yy - xy * xy - ((trace * trace) >> 4)
            scores[y * w + x] = score
            best = max(best, score)
    return best


@kernel
def peak_between(costs: u16[:], n: i32) -> i32:
    best = 0
    for i in range(1, n):
        if costs[i] < costs[best]:
            best = i
    if best == 0 or best == n - 1:
        return best << 8
    left = costs[best - 1]
    right = costs[best + 1]
    bend = left - 2 * costs[best] + right
    if bend == 0:
        return best << 8
    return (best << 8) + ((left - right) << 7) // bend


@kernel
def pair_edges(strengths: i16[:], n: i32, least: i32, widest: i32, pairs: u16[:]) -> i32:
    found = 0
    start = -1
    for x in range(n):
        strength = strengths[x]
        if strength >= least:
            start = x
        elif strength <= -least and start >= 0:
            if x - start <= widest:
                pairs[found] = start
                pairs[found + 1] = x
                found += 2
            start = -1
    return found >> 1


@kernel
def stretch_row(row: u8[:], n: i32, out: u8[:]) -> None:
    low = 255
    high = 0
    for x in range(n):
        low = min(low, row[x])
        high = max(high, row[x])
    if high == low:
        for x in range(n):
            out[x] = row[x]
        return
    scale = (255 << 8) // (high - low)
    for x in range(n):
        out[x] = ((row[x] - low) * scale + 128) >> 8


def play_crossings(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    places = np.zeros(400, np.uint16)
    found = run(lcg.scaled(400, 201, -100), 400, 60, places)
    return places, word(found)


def play_corners(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    w, h = 16, 12
    scores = np.zeros(w * h, np.int32)
    best = run(lcg.scaled(w * h, 255, -127), lcg.scaled(w * h, 255, -127), w, h, scores)
    return scores, word(best)


def play_peaks(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    return (np.array([run(lcg.scaled(32, 5000, 10, "u2"), 32) for _ in range(12)], np.int32),)


def play_pairs(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    pairs = np.zeros(600, np.uint16)
    found = run(lcg.scaled(500, 201, -100), 500, 70, 6, pairs)
    return pairs, word(found)


def play_stretch(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    rows = lcg.scaled(300, 120, 60, "u1"), np.full(40, 77, np.uint8)
    outs = [np.zeros(len(row), np.uint8) for row in rows]
    for row, out in zip(rows, outs, strict=True):
        run(row, len(row), out)
    return (*outs,)


CASES = (
    Case(zero_crossings, 2711, play_crossings, exported=True),
    Case(corner_scores, 2712, play_corners, exported=True),
    Case(peak_between, 2713, play_peaks, exported=True),
    Case(pair_edges, 2714, play_pairs, exported=True),
    Case(stretch_row, 2715, play_stretch, exported=True),
)
