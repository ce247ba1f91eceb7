"""What is kept, found again and packed: a cache of blocks, a tree of points, a picture's code, a cipher."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i8, i16, i32, kernel, u8, u16

EMPTY = 65535
ENDS = 16
NONE = 255
FAR = 0x7FFFFFFF


@kernel
def lru_cache(
    blocks: u16[:],
    n: i32,
    keys: u16[:],
    newer: u8[:],
    older: u8[:],
    chain: u8[:],
    buckets: u8[:],
    evicted: u16[:],
) -> i32:
    """Blocks in a cache of 16 places, in a list by their last use and in chains by their number; how often one was there."""
    for at in range(16):
        keys[at] = EMPTY
        older[at] = at + 1
        newer[at + 1] = at
        buckets[at] = NONE
    older[ENDS] = 0
    newer[0] = ENDS
    hits = 0
    gone = 0
    for i in range(n):
        block = blocks[i]
        at = buckets[block & 15]
        while at != NONE and keys[at] != block:
            at = chain[at]
        if at != NONE:
            hits += 1
        else:
            at = newer[ENDS]
            if keys[at] != EMPTY:
                evicted[gone] = keys[at]
                gone += 1
                bucket = keys[at] & 15
                if buckets[bucket] == at:
                    buckets[bucket] = chain[at]
                else:
                    before = buckets[bucket]
                    while chain[before] != at:
                        before = chain[before]
                    chain[before] = chain[at]
            keys[at] = block
            chain[at] = buckets[block & 15]
            buckets[block & 15] = at
        newer[older[at]] = newer[at]
        older[newer[at]] = older[at]
        newest = older[ENDS]
        older[at] = newest
        newer[at] = ENDS
        newer[newest] = at
        older[ENDS] = at
    return hits


@kernel
def kd_nearest(
    xs: i16[:],
    ys: i16[:],
    axes: u8[:],
    lower: i16[:],
    upper: i16[:],
    stack: i16[:],
    gaps: i32[:],
    qx: i32,
    qy: i32,
) -> i32:
    """The point of a tree that is nearest to another one; each point halves the plane, across or along."""
    least = FAR
    nearest = -1
    stack[0] = 0
    gaps[0] = 0
    top = 1
    while top > 0:
        top -= 1
        if gaps[top] >= least:
            continue
        at = stack[top]
        while at >= 0:
            dx = qx - xs[at]
            dy = qy - ys[at]
            square = dx * dx + dy * dy
            if square < least:
                least = square
                nearest = at
            off = dy if axes[at] else dx
            if off < 0:
                near = lower[at]
                far = upper[at]
            else:
                near = upper[at]
                far = lower[at]
            if far >= 0 and off * off < least:
                stack[top] = far
                gaps[top] = off * off
                top += 1
            at = near
    return nearest


@kernel
def qoi_encode(pixels: u8[:], n: i32, known: i32[:], out: u8[:]) -> i32:
    """A picture as the "quite OK image format" has it: runs, colours seen before, small differences; returns its bytes."""
    for i in range(64):
        known[i] = -1
    before = 0
    made = 0
    repeats = 0
    for i in range(0, 3 * n, 3):
        r = pixels[i]
        g = pixels[i + 1]
        b = pixels[i + 2]
        colour = (r << 16) | (g << 8) | b
        if colour == before:
            repeats += 1
            if repeats == 62:
                out[made] = 0xC0 | (repeats - 1)
                made += 1
                repeats = 0
            continue
        if repeats > 0:
            out[made] = 0xC0 | (repeats - 1)
            made += 1
            repeats = 0
        place = (3 * r + 5 * g + 7 * b + 11 * 255) & 63
        if known[place] == colour:
            out[made] = place
            made += 1
        else:
            known[place] = colour
            dr = i8(r - (before >> 16))
            dg = i8(g - (before >> 8))
            db = i8(b - before)
            if -2 <= dr <= 1 and -2 <= dg <= 1 and -2 <= db <= 1:
                out[made] = 0x40 | ((dr + 2) << 4) | ((dg + 2) << 2) | (db + 2)
                made += 1
            elif -32 <= dg <= 31 and -8 <= dr - dg <= 7 and -8 <= db - dg <= 7:
                out[made] = 0x80 | (dg + 32)
                out[made + 1] = ((dr - dg + 8) << 4) | (db - dg + 8)
                made += 2
            else:
                out[made] = 0xFE
                out[made + 1] = r
                out[made + 2] = g
                out[made + 3] = b
                made += 4
        before = colour
    if repeats > 0:
        out[made] = 0xC0 | (repeats - 1)
        made += 1
    return made


@kernel
def aes_encrypt(data: u8[:], blocks: i32, key: u8[:], sbox: u8[:], keys: u8[:], shifted: u8[:]) -> None:
    """Encrypt blocks of 16 bytes in place, each by itself (AES-128); `keys` takes 176 bytes."""
    for i in range(16):
        keys[i] = key[i]
    constant = 1
    for i in range(16, 176, 4):
        a = keys[i - 4]
        b = keys[i - 3]
        c = keys[i - 2]
        d = keys[i - 1]
        if i & 15 == 0:
            first = a
            a = sbox[b] ^ constant
            b = sbox[c]
            c = sbox[d]
            d = sbox[first]
            constant = (constant << 1) ^ ((constant >> 7) * 0x11B)
        keys[i] = keys[i - 16] ^ a
        keys[i + 1] = keys[i - 15] ^ b
        keys[i + 2] = keys[i - 14] ^ c
        keys[i + 3] = keys[i - 13] ^ d
    for block in range(0, 16 * blocks, 16):
        for i in range(16):
            data[block + i] ^= keys[i]
        for turn in range(1, 11):
            for column in range(4):
                for row in range(4):
                    shifted[4 * column + row] = sbox[data[block + ((4 * (column + row) + row) & 15)]]
            if turn < 10:
                for at in range(0, 16, 4):
                    a = shifted[at]
                    b = shifted[at + 1]
                    c = shifted[at + 2]
                    d = shifted[at + 3]
                    every = a ^ b ^ c ^ d
                    ab = a ^ b
                    bc = b ^ c
                    cd = c ^ d
                    da = d ^ a
                    shifted[at] = a ^ every ^ (ab << 1) ^ ((ab >> 7) * 0x11B)
                    shifted[at + 1] = b ^ every ^ (bc << 1) ^ ((bc >> 7) * 0x11B)
                    shifted[at + 2] = c ^ every ^ (cd << 1) ^ ((cd >> 7) * 0x11B)
                    shifted[at + 3] = d ^ every ^ (da << 1) ^ ((da >> 7) * 0x11B)
            for i in range(16):
                data[block + i] = shifted[i] ^ keys[16 * turn + i]


def play_cache(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    blocks, evicted = np.zeros(300, np.uint16), np.zeros(300, np.uint16)
    for i in range(300):
        blocks[i] = 40 + (i >> 3) + lcg.below(6) if lcg.below(4) else lcg.below(64)
    keys, newer, older = np.zeros(17, np.uint16), np.zeros(17, np.uint8), np.zeros(17, np.uint8)
    hits = run(blocks, 300, keys, newer, older, np.zeros(16, np.uint8), np.zeros(16, np.uint8), evicted)
    return evicted, word(hits)


def play_tree(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    xs, ys = lcg.scaled(120, 1000, 0), lcg.scaled(120, 1000, 0)
    axes, children = np.zeros(120, np.uint8), np.full((2, 120), -1, np.int16)
    for i in range(1, 120):
        at, child = 0, 0
        while child >= 0:
            axis = int(axes[at])
            values = ys if axis else xs
            side = int(values[i] >= values[at])
            child = int(children[side, at])
            if child < 0:
                children[side, at] = i
                axes[i] = 1 - axis
            at = child
    stack, gaps, nearest = np.zeros(40, np.int16), np.zeros(40, np.int32), np.zeros(40, np.int16)
    for i in range(40):
        x, y = lcg.below(1000), lcg.below(1000)
        nearest[i] = run(xs, ys, axes, children[0], children[1], stack, gaps, x, y)
    return (nearest,)


def play_qoi(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    pixels, colour = np.zeros(3 * 400, np.uint8), [90, 120, 60]
    for i in range(400):
        kind = lcg.below(8)
        if kind == 0:
            colour = [lcg.u8() for _ in range(3)]
        elif kind < 3:
            colour = [(c + lcg.below(3) - 1) & 255 for c in colour]
        elif kind == 3:
            step = lcg.below(21) - 10
            colour = [(c + step + lcg.below(5) - 2) & 255 for c in colour]
        elif kind == 4 and i > 9:
            colour = [int(c) for c in pixels[3 * (i - 9) : 3 * (i - 9) + 3]]
        pixels[3 * i : 3 * i + 3] = colour
    out = np.zeros(1600, np.uint8)
    made = run(pixels, 400, np.zeros(64, np.int32), out)
    return out, word(made)


def substitutes() -> Array:
    """Return the substitution of AES: inverses in its field, and an affine map of their bits."""
    sbox, p, q = np.zeros(256, np.uint8), 1, 1
    sbox[0] = 0x63
    for _ in range(255):
        p ^= ((p << 1) & 255) ^ (0x1B if p & 0x80 else 0)
        for shift in (1, 2, 4):
            q ^= (q << shift) & 255
        if q & 0x80:
            q ^= 0x09
        twice = q | q << 8
        sbox[p] = (q ^ (twice >> 7) ^ (twice >> 6) ^ (twice >> 5) ^ (twice >> 4) ^ 0x63) & 255
    return sbox


def play_aes(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    data, key = lcg.bytes(16 * 6), lcg.bytes(16)
    run(data, 6, key, substitutes(), np.zeros(176, np.uint8), np.zeros(16, np.uint8))
    return (data,)


CASES = (
    Case(lru_cache, 3041, play_cache),
    Case(kd_nearest, 3042, play_tree),
    Case(qoi_encode, 3043, play_qoi),
    Case(aes_encrypt, 3044, play_aes),
)
