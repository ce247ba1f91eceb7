"""Estimates from noise: a threshold from a histogram, a tracking filter, votes for lines, nearest colours, an envelope."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.api import quotient
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def otsu_threshold(histogram: u16[:], pixels: i32) -> i32:
    total = 0
    for level in range(64):
        total += level * histogram[level]
    below = 0
    weighted = 0
    best = 0
    best_level = 0
    for level in range(64):
        below += histogram[level]
        if below == 0:
            continue
        above = pixels - below
        if above == 0:
            break
        weighted += level * histogram[level]
        low = quotient(weighted << 4, below)
        high = quotient((total - weighted) << 4, above)
        between = ((below * above) >> 8) * (((high - low) * (high - low)) >> 8)
        if between > best:
            best = between
            best_level = level
    return best_level


@kernel
def alpha_beta(measured: i16[:], n: i32, alpha: i32, beta: i32, positions: i16[:]) -> i32:
    x = measured[0] << 8
    v = 0
    lost = 0
    for i in range(n):
        x += v
        z = measured[i]
        if z != -32768:
            r = (z << 8) - x
            if abs(r) > 25600:
                lost += 1
            else:
                x += (r >> 8) * alpha
                v += ((r >> 4) * beta) >> 4
        positions[i] = x >> 8
    return lost


@kernel
def line_votes(xs: u8[:], ys: u8[:], n: i32, cosines: i16[:], sines: i16[:], votes: u8[:]) -> i32:
    most = 0
    place = 0
    for i in range(n):
        x = xs[i]
        y = ys[i]
        for a in range(32):
            r = (x * cosines[a] + y * sines[a]) >> 14
            at = (a << 6) + ((r + 128) >> 2)
            count = votes[at] + 1
            votes[at] = count
            if count > most:
                most = count
                place = at
    return place


@kernel
def nearest_colours(pixels: u8[:], n: i32, palette: u8[:], colours: i32, out: u8[:]) -> None:
    for i in range(n):
        r = pixels[3 * i]
        g = pixels[3 * i + 1]
        b = pixels[3 * i + 2]
        nearest = 1 << 20
        for c in range(colours):
            dr = r - palette[3 * c]
            d = dr * dr
            if d >= nearest:
                continue
            dg = g - palette[3 * c + 1]
            d += dg * dg
            if d >= nearest:
                continue
            db = b - palette[3 * c + 2]
            d += db * db
            if d < nearest:
                nearest = d
                out[i] = c


@kernel
def envelope(samples: i16[:], n: i32, bins: u16[:], out: i16[:]) -> i32:
    level = 0
    clipped = 0
    for i in range(n):
        s = abs(samples[i])
        if s > level:
            level += (s - level) >> 2
        else:
            level -= (level - s) >> 5
        if s >= 32000:
            clipped += 1
        bins[level >> 11] += 1
        out[i] = level
    return clipped


def play_otsu(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    levels = np.r_[lcg.scaled(700, 25, 5), lcg.scaled(500, 20, 38)]
    histogram = np.bincount(levels, minlength=64).astype(np.uint16)
    return (word(run(histogram, 1200)),)


def play_tracking(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    measured = (np.arange(400) * 3 + lcg.scaled(400, 40)).astype(np.int16)
    measured[::17] = -32768
    measured[5::29] += 4000
    measured[0] = 0
    positions = np.zeros(400, np.int16)
    lost = run(measured, 400, 90, 12, positions)
    return positions, word(lost)


def play_votes(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    angles = np.arange(32) * np.pi / 32
    cosines = np.round(np.cos(angles) * 8191).astype(np.int16)
    sines = np.round(np.sin(angles) * 8191).astype(np.int16)
    votes = np.zeros(32 * 64, np.uint8)
    xs, ys = lcg.scaled(40, 200, kind="u1"), lcg.scaled(40, 150, kind="u1")
    place = run(xs, ys, 40, cosines, sines, votes)
    return votes, word(place)


def play_colours(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(100, np.uint8)
    run(lcg.bytes(300), 100, lcg.bytes(48), 16, out)
    return (out,)


def play_envelope(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples = np.array([(lcg.u16() - 32768) >> (i >> 6 & 3) for i in range(500)], np.int16)
    bins, out = np.zeros(16, np.uint16), np.zeros(500, np.int16)
    clipped = run(samples, 500, bins, out)
    return bins, out, word(clipped)


CASES = (
    Case(otsu_threshold, 2111, play_otsu, exported=True),
    Case(alpha_beta, 2112, play_tracking, exported=True),
    Case(line_votes, 2113, play_votes, exported=True),
    Case(nearest_colours, 2114, play_colours, exported=True),
    Case(envelope, 2115, play_envelope, exported=True),
)
