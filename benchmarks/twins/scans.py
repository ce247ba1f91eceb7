"""Scan lines: specks, colours of a mosaic, disparities by row, a laser's line, colours of a display, maxima of windows."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, quotient, u8, u16, u32


@kernel
def despeckle_words(bits: u32[:], words: i32, rows: i32, out: u32[:]) -> None:
    """Clear the pixels without a neighbour at one of four sides; 32 pixels a word, the leftmost in bit 31."""
    for y in range(rows):
        for i in range(words):
            p = y * words + i
            here = bits[p]
            near = (here << 1) | (here >> 1)
            if i > 0:
                near |= bits[p - 1] << 31
            if i < words - 1:
                near |= bits[p + 1] >> 31
            if y > 0:
                near |= bits[p - words]
            if y < rows - 1:
                near |= bits[p + words]
            out[p] = here & near


@kernel
def demosaic_row(above: u8[:], here: u8[:], below: u8[:], out: u8[:], w: i32) -> None:
    """Colours of a row of red and green pixels, the first is red."""
    for x in range(1, w - 2, 2):
        out[3 * x] = (here[x - 1] + here[x + 1]) >> 1
        out[3 * x + 1] = here[x]
        out[3 * x + 2] = (above[x] + below[x]) >> 1
        out[3 * x + 3] = here[x + 1]
        out[3 * x + 4] = (here[x] + here[x + 2] + above[x + 1] + below[x + 1]) >> 2
        out[3 * x + 5] = (above[x] + above[x + 2] + below[x] + below[x + 2]) >> 2


@kernel
def v_disparity(disparity: u8[:], w: i32, h: i32, levels: i32, counts: u16[:], peaks: u8[:]) -> None:
    """Histogram of disparities in each row, and the most frequent; 0 is no disparity."""
    for i in range(h * levels):
        counts[i] = 0
    for y in range(h):
        row = y * levels
        for x in range(w):
            d = disparity[y * w + x]
            if d > 0:
                counts[row + min(d, levels - 1)] += 1
        most = 0
        peak = 0
        for level in range(1, levels):
            if counts[row + level] > most:
                most = i32(counts[row + level])
                peak = level
        peaks[y] = peak


@kernel
def laser_profile(image: u8[:], w: i32, h: i32, threshold: i32, out: i16[:]) -> None:
    """Where each column is brightest, in 16ths of a row; -1 where it is dark."""
    for x in range(w):
        best = 0
        at = 0
        for y in range(h):
            v = image[y * w + x]
            if v > best:
                best = v
                at = y
        if best < threshold:
            out[x] = -1
            continue
        total = 0
        moment = 0
        for y in range(max(at - 3, 0), min(at + 4, h)):
            v = image[y * w + x]
            total += v
            moment += v * y
        out[x] = quotient(16 * moment + (total >> 1), total)


@kernel
def dither_565(rgb: u8[:], pattern: u8[:], w: i32, y: i32, out: u16[:]) -> None:
    """Pixels of 16 bits, with an ordered dither of 4 x 4."""
    row = 4 * (y & 3)
    for x in range(w):
        t = pattern[row + (x & 3)]
        r = min(rgb[3 * x] + (t >> 1), 255)
        g = min(rgb[3 * x + 1] + (t >> 2), 255)
        b = min(rgb[3 * x + 2] + (t >> 1), 255)
        out[x] = ((r >> 3) << 11) | ((g >> 2) << 5) | (b >> 3)


@kernel
def sliding_maximum(x: i16[:], n: i32, window: i32, queue: i16[:], out: i16[:]) -> None:
    """Maxima of windows, by a queue of falling values."""
    head = 0
    tail = 0
    for i in range(n):
        while tail > head and x[queue[tail - 1]] <= x[i]:
            tail -= 1
        queue[tail] = i
        tail += 1
        if queue[head] <= i - window:
            head += 1
        if i >= window - 1:
            out[i - window + 1] = x[queue[head]]


def play_despeckle(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    bits = np.array([lcg.next() & lcg.next() for _ in range(10 * 24)], np.uint32)
    out = np.zeros(10 * 24, np.uint32)
    run(bits, 10, 24, out)
    return (out,)


def play_demosaic(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    above, here, below = (lcg.bytes(320) for _ in range(3))
    out = np.zeros(960, np.uint8)
    run(above, here, below, out, 320)
    return (out,)


def play_disparity(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    counts, peaks = np.zeros(24 * 32, np.uint16), np.zeros(24, np.uint8)
    run(lcg.scaled(80 * 24, 36, 0, "u1"), 80, 24, 32, counts, peaks)
    return counts, peaks


def play_laser(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image, out = lcg.scaled(64 * 48, 50, 0, "u1").reshape(48, 64), np.zeros(64, np.int16)
    for x in range(64):
        if x % 16 != 5:
            for k in range(-2, 3):
                image[20 + x // 4 + k, x] += 160 - 50 * abs(k)
    run(image.reshape(-1), 64, 48, 120, out)
    return (out,)


def play_dither(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    pattern = np.array([0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5], np.uint8)
    rgb, out = lcg.bytes(4 * 480), np.zeros(4 * 160, np.uint16)
    for y in range(4):
        run(rgb[480 * y : 480 * y + 480], pattern, 160, y, out[160 * y : 160 * y + 160])
    return (out,)


def play_maximum(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    x, queue, out = lcg.scaled(300, 2000, -1000), np.zeros(300, np.int16), np.zeros(286, np.int16)
    run(x, 300, 15, queue, out)
    return (out,)


CASES = (
    Case(despeckle_words, 2811, play_despeckle),
    Case(demosaic_row, 2812, play_demosaic),
    Case(v_disparity, 2813, play_disparity),
    Case(laser_profile, 2814, play_laser),
    Case(dither_565, 2815, play_dither),
    Case(sliding_maximum, 2816, play_maximum),
)
