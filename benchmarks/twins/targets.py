"""What a robot looks for: a template in any light, a colour that moves, points that it knows again, a marker."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i8, i16, i32, kernel, quotient, u8, u16, u32


@kernel
def square_root(v: i32) -> i32:
    """The square root, bit by bit."""
    root = 0
    bit = 1 << 28
    while bit > v:
        bit >>= 2
    while bit > 0:
        if v >= root + bit:
            v -= root + bit
            root = (root >> 1) + bit
        else:
            root >>= 1
        bit >>= 2
    return root


@kernel
def ncc_search(picture: u8[:], w: i32, h: i32, template: u8[:], side: i32, scores: u8[:]) -> i32:
    """Where a template is most alike, whatever the light; scores in 255ths, 0 where the picture is flat."""
    area = side * side
    mean = 0
    own = 0
    for i in range(area):
        mean += template[i]
        own += template[i] * template[i]
    own = square_root(area * own - mean * mean)
    most = 0
    best = -1
    at = 0
    for y in range(h - side + 1):
        for x in range(w - side + 1):
            total = 0
            squares = 0
            products = 0
            for v in range(side):
                for u in range(side):
                    p = picture[(y + v) * w + x + u]
                    total += p
                    squares += p * p
                    products += p * template[v * side + u]
            score = 0
            likeness = area * products - total * mean
            spread = area * squares - total * total
            if likeness > 0 and spread > 25 * area * area:
                score = min(quotient(likeness, max((own * square_root(spread)) >> 8, 1)), 255)
            scores[at] = score
            if score > most:
                most = score
                best = at
            at += 1
    return best


@kernel
def mean_shift(likely: u8[:], w: i32, h: i32, window: i16[:], most: i32) -> i32:
    """Move a window (middle and half of its size) to where a map is densest; returns the turns that it took."""
    x = window[0]
    y = window[1]
    half_w = window[2]
    half_h = window[3]
    turns = 0
    while turns < most:
        turns += 1
        mass = 0
        sum_x = 0
        sum_y = 0
        for v in range(max(y - half_h, 0), min(y + half_h + 1, h)):
            line = 0
            for u in range(max(x - half_w, 0), min(x + half_w + 1, w)):
                p = likely[v * w + u]
                if p > 32:
                    line += p
                    sum_x += p * (u - x)
            mass += line
            sum_y += line * (v - y)
        if mass == 0:
            break
        dx = quotient(sum_x, mass)
        dy = quotient(sum_y, mass)
        x += dx
        y += dy
        if dx == 0 and dy == 0:
            break
    window[0] = x
    window[1] = y
    return turns


@kernel
def turned_offset(x: i32, y: i32, sine: i32, cosine: i32, w: i32) -> i32:
    u = (x * cosine - y * sine + 8192) >> 14
    v = (x * sine + y * cosine + 8192) >> 14
    return v * w + u


@kernel
def brief_words(
    picture: u8[:],
    w: i32,
    xs: i16[:],
    ys: i16[:],
    turns: u8[:],
    n: i32,
    pairs: i8[:],
    sines: i16[:],
    words: u32[:],
) -> None:
    """Descriptors of points in 64 bits: which of two pixels is brighter, turned as the point is (32 a turn)."""
    for i in range(n):
        sine = sines[turns[i]]
        cosine = sines[(turns[i] + 8) & 31]
        at = ys[i] * w + xs[i]
        p = 0
        for k in range(2):
            bits: u32 = 0
            for _ in range(32):
                first = picture[at + turned_offset(pairs[p], pairs[p + 1], sine, cosine, w)]
                second = picture[at + turned_offset(pairs[p + 2], pairs[p + 3], sine, cosine, w)]
                bits <<= 1
                if first < second:
                    bits |= 1
                p += 4
            words[2 * i + k] = bits


@kernel
def quarter_turned(code: i32) -> i32:
    """A code of 4 x 4 bits, a quarter turn on."""
    turned = 0
    for column in range(4):
        for row in range(3, -1, -1):
            turned = (turned << 1) | ((code >> (15 - 4 * row - column)) & 1)
    return turned


@kernel
def read_marker(picture: u8[:], w: i32, h: i32, plane: i32[:], threshold: i32, codes: u16[:], n: i32) -> i32:
    """The marker of 4 x 4 bits in a black frame under a homography: four times its number, and its quarter turns; or -1."""
    code = 0
    for row in range(6):
        for column in range(6):
            u = 2 * column + 1
            v = 2 * row + 1
            z = plane[6] * u + plane[7] * v + plane[8]
            x = quotient(plane[0] * u + plane[1] * v + plane[2], z)
            y = quotient(plane[3] * u + plane[4] * v + plane[5], z)
            if x < 0 or y < 0 or x >= w or y >= h:
                return -1
            white = 1 if picture[y * w + x] > threshold else 0
            if row == 0 or row == 5 or column == 0 or column == 5:
                if white:
                    return -1
            else:
                code = (code << 1) | white
    least = 3
    best = -1
    for turn in range(4):
        for i in range(n):
            off = 0
            different = code ^ codes[i]
            while different:
                different &= different - 1
                off += 1
            if off < least:
                least = off
                best = 4 * i + turn
        code = quarter_turned(code)
    return best


def play_ncc(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    template = lcg.bytes(8 * 8)
    picture = lcg.scaled(24 * 14, 60, 100, "u1")
    for v in range(8):
        for u in range(8):
            picture[(v + 3) * 24 + u + 11] = 40 + (int(template[8 * v + u]) >> 1) + lcg.below(20)
    scores = np.zeros(17 * 7, np.uint8)
    best = run(picture, 24, 14, template, 8, scores)
    return scores, word(best)


def play_shift(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    likely = lcg.scaled(64 * 40, 48, 0, "u1")
    for y in range(18, 33):
        for x in range(36, 54):
            likely[64 * y + x] = 120 + lcg.below(100)
    window, turns = np.array([30, 12, 9, 8], np.int16), np.zeros(1, np.int32)
    turns[0] = run(likely, 64, 40, window, 12)
    return window, turns


def play_brief(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    sines = np.zeros(32, np.int16)
    for i in range(32):
        turn = i & 15
        sines[i] = 256 * turn * (16 - turn) * (1 if i < 16 else -1)
    picture, pairs = lcg.bytes(48 * 40), lcg.scaled(4 * 64, 17, -8, "i1")
    xs, ys = lcg.scaled(10, 48 - 26, 13), lcg.scaled(10, 40 - 26, 13)
    turns, words = lcg.scaled(10, 32, 0, "u1"), np.zeros(20, np.uint32)
    run(picture, 48, xs, ys, turns, 10, pairs, sines, words)
    return (words,)


def play_marker(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    codes, found = lcg.scaled(16, 65536, 0, "u2"), np.zeros(8, np.int32)
    for i in range(8):
        picture = lcg.scaled(48 * 48, 60, 0, "u1")
        code = int(codes[lcg.below(16)]) ^ (1 << lcg.below(16))
        for y in range(8, 32):
            for x in range(8, 32):
                bit = 4 * ((y - 8) // 6) + (x - 8) // 6
                if (code >> (15 - bit)) & 1:
                    picture[48 * y + x] = 150 + lcg.below(100)
        plane = np.array([3072, 0, 2048, 0, 3072, 2048, lcg.below(8), lcg.below(8), 1024], np.int32)
        if i & 1:  # seen from another side
            plane[:6] = 0, -3072, 38 * 1024, 3072, 0, 2048
        found[i] = run(picture, 48, 48, plane, 100, codes, 16)
    return (found,)


CASES = (
    Case(ncc_search, 3011, play_ncc),
    Case(mean_shift, 3012, play_shift),
    Case(brief_words, 3013, play_brief),
    Case(read_marker, 3014, play_marker),
)
