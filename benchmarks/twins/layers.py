"""Pictures through windows: edges kept, contrast limited, depth along a row, a layer of a network."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i8, i16, i32, kernel, quotient, u8, u16

FAR = 0x7FFFFFFF
LEVELS = 64
OUTSIDE = 65535


@kernel
def kuwahara(picture: u8[:], w: i32, h: i32, out: u8[:]) -> None:
    """Of the four windows of 3 x 3 with a pixel in their corner, the mean of the one that varies least."""
    for y in range(2, h - 2):
        for x in range(2, w - 2):
            least = FAR
            calmest = 0
            for quadrant in range(4):
                at = (y - 2 * (quadrant >> 1)) * w + x - 2 * (quadrant & 1)
                total = 0
                squares = 0
                for _ in range(3):
                    for u in range(3):
                        p = picture[at + u]
                        total += p
                        squares += p * p
                    at += w
                spread = 9 * squares - total * total
                if spread < least:
                    least = spread
                    calmest = total
            out[y * w + x] = quotient(calmest + 4, 9)


@kernel
def clahe_tile(tile: u8[:], stride: i32, w: i32, h: i32, limit: i32, counts: u16[:], levels: u8[:]) -> i32:
    """New levels of a tile by its histogram; what is above the limit goes to all. Returns how much that is."""
    for i in range(LEVELS):
        counts[i] = 0
    for y in range(h):
        for x in range(w):
            counts[tile[y * stride + x] >> 2] += 1
    cut = 0
    for i in range(LEVELS):
        if counts[i] > limit:
            cut += counts[i] - limit
            counts[i] = limit
    share = quotient(cut, LEVELS)
    rest = cut - share * LEVELS
    for i in range(LEVELS):
        counts[i] += share
    if rest > 0:
        step = quotient(LEVELS, rest)
        i = 0
        while i < LEVELS and rest > 0:
            counts[i] += 1
            rest -= 1
            i += step
    total = 0
    for i in range(LEVELS):
        total += counts[i]
        levels[i] = min(quotient(255 * total, w * h), 255)
    return cut


@kernel
def sgm_row(
    costs: u8[:], n: i32, depth: i32, small: i32, large: i32, paths: u16[:], sums: u16[:], best: u8[:]
) -> None:
    """Semi-global matching along a row: paths with small and large steps of disparity; `paths` has a place more at either end."""
    paths[0] = OUTSIDE
    paths[depth + 1] = OUTSIDE
    for d in range(1, depth + 1):
        paths[d] = 0
    least = 0
    at = 0
    for x in range(n):
        next_least = OUTSIDE
        lowest = OUTSIDE
        choice = 0
        nearer = OUTSIDE
        for d in range(depth):
            here = paths[d + 1]
            path = min(here, min(nearer, paths[d + 2]) + small)
            path = min(path, least + large) - least + costs[at]
            nearer = here
            paths[d + 1] = path
            next_least = min(next_least, path)
            total = sums[at] + path
            sums[at] = total
            at += 1
            if total < lowest:
                lowest = total
                choice = d
        best[x] = choice
        least = next_least


@kernel
def depthwise_q7(
    x: i8[:],
    w: i32,
    h: i32,
    channels: i32,
    weights: i8[:],
    biases: i32[:],
    scales: i16[:],
    shift: i32,
    out: i8[:],
) -> None:
    """A layer of a network: each channel by its own 3 x 3 weights, scaled to bytes, and nothing below 0."""
    for row in range(h):
        for column in range(w):
            for c in range(channels):
                total = biases[c]
                for ky in range(3):
                    v = row + ky - 1
                    if v < 0 or v >= h:
                        continue
                    for kx in range(3):
                        u = column + kx - 1
                        if u < 0 or u >= w:
                            continue
                        total += x[(v * w + u) * channels + c] * weights[(3 * ky + kx) * channels + c]
                scaled = ((total >> 2) * scales[c] + (1 << (shift - 1))) >> shift
                out[(row * w + column) * channels + c] = min(max(scaled, 0), 127)


def play_kuwahara(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture = np.zeros(32 * 16, np.uint8)
    for i in range(32 * 16):
        picture[i] = (60 if (i & 31) < 13 + (i >> 6) else 150) + lcg.below(50)
    out = np.zeros(32 * 16, np.uint8)
    run(picture, 32, 16, out)
    return (out,)


def play_clahe(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture = np.zeros(48 * 32, np.uint8)
    for i in range(48 * 32):
        picture[i] = 90 + lcg.below(20) + lcg.below(20) + (lcg.below(100) if i % 48 > 30 else 0)
    counts, levels, cuts = np.zeros(64, np.uint16), np.zeros(4 * 64, np.uint8), np.zeros(4, np.int32)
    for i in range(4):
        corner = (i >> 1) * 16 * 48 + (i & 1) * 24
        cuts[i] = run(picture[corner:], 48, 24, 16, 20, counts, levels[64 * i : 64 * i + 64])
    return levels, cuts


def play_sgm(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    costs, sums = np.zeros(48 * 16, np.uint8), np.zeros(48 * 16, np.uint16)
    for x in range(48):
        disparity = 4 if x < 20 else 9
        for d in range(16):
            costs[16 * x + d] = 6 * abs(d - disparity) + lcg.below(60)
            sums[16 * x + d] = lcg.below(200)
    paths, best = np.zeros(18, np.uint16), np.zeros(48, np.uint8)
    run(costs, 48, 16, 10, 60, paths, sums, best)
    return best, sums


def play_depthwise(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    x, weights = lcg.scaled(8 * 6 * 4, 256, -128, "i1"), lcg.scaled(9 * 4, 256, -128, "i1")
    biases, scales = lcg.scaled(4, 20000, -10000, "i4"), lcg.scaled(4, 3000, 1000)
    out = np.zeros(8 * 6 * 4, np.int8)
    run(x, 8, 6, 4, weights, biases, scales, 18, out)
    return (out,)


CASES = (
    Case(kuwahara, 3001, play_kuwahara),
    Case(clahe_tile, 3002, play_clahe),
    Case(sgm_row, 3003, play_sgm),
    Case(depthwise_q7, 3004, play_depthwise),
)
