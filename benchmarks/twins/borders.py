"""Borders: gradients beyond a threshold, weak edges beside strong ones, an outline followed, corners on a ring, peaks."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def prewitt_edges(picture: u8[:], out: u8[:], w: i32, h: i32, threshold: i32) -> i32:
    count = 0
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            gx = 0
            gy = 0
            for k in range(-1, 2):
                gx += picture[(y + k) * w + x + 1] - picture[(y + k) * w + x - 1]
                gy += picture[(y + 1) * w + x + k] - picture[(y - 1) * w + x + k]
            if gx * gx + gy * gy > threshold:
                out[y * w + x] = 1
                count += 1
    return count


@kernel
def strengthen_edges(edges: u8[:], w: i32, h: i32) -> i32:
    passes = 0
    changed = 1
    while changed != 0 and passes < 8:
        changed = 0
        for y in range(1, h - 1):
            for x in range(1, w - 1):
                at = y * w + x
                if edges[at] != 1:
                    continue
                if edges[at - 1] == 2 or edges[at + 1] == 2 or edges[at - w] == 2 or edges[at + w] == 2:
                    edges[at] = 2
                    changed += 1
        passes += 1
    return passes


@kernel
def follow_outline(mask: u8[:], w: i32, start: i32, steps: i16[:], chain: u8[:], longest: i32) -> i32:
    at = start
    direction = 0
    length = 0
    while length < longest:
        turn = (direction + 6) & 7
        tries = 0
        while tries < 8 and mask[at + steps[turn]] == 0:
            turn = (turn + 1) & 7
            tries += 1
        if tries == 8:
            break
        at += steps[turn]
        direction = turn
        chain[length] = turn
        length += 1
        if at == start:
            break
    return length


@kernel
def ring_corners(picture: u8[:], ring: i16[:], out: u8[:], w: i32, h: i32, contrast: i32) -> i32:
    found = 0
    for y in range(3, h - 3):
        for x in range(3, w - 3):
            at = y * w + x
            centre = picture[at]
            bright = 0
            dark = 0
            longest = 0
            for k in range(24):
                value = picture[at + ring[k & 15]]
                if value > centre + contrast:
                    bright += 1
                    dark = 0
                elif value < centre - contrast:
                    dark += 1
                    bright = 0
                else:
                    bright = 0
                    dark = 0
                run = max(bright, dark)
                longest = max(longest, run)
            if longest >= 9:
                out[at] = longest
                found += 1
    return found


@kernel
def vote_peaks(votes: u16[:], angles: i32, radii: i32, least: i32, found: i16[:], most: i32) -> i32:
    count = 0
    for a in range(1, angles - 1):
        for r in range(1, radii - 1):
            at = a * radii + r
            here = votes[at]
            if here < least:
                continue
            if here <= votes[at - 1] or here < votes[at + 1]:
                continue
            if here <= votes[at - radii] or here < votes[at + radii]:
                continue
            if count == most:
                return count
            found[2 * count] = a
            found[2 * count + 1] = r
            count += 1
    return count


def play_prewitt(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(30 * 20, np.uint8)
    count = run(lcg.bytes(30 * 20), out, 30, 20, 60000)
    return out, word(count)


def play_strengthen(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    edges = np.array([0, 0, 1, 1, 1, 0, 1, 2], np.uint8)[lcg.bytes(30 * 20) & 7]
    edges[lcg.bytes(30 * 20) > 60] &= 1
    passes = run(edges, 30, 20)
    return edges, word(passes)


def play_outline(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    y, x = np.mgrid[:48, :48] - 24
    angle = np.arctan2(y, x)
    mask = (np.hypot(x, y) < 16 + 4 * np.sin(5 * angle)).astype(np.uint8)
    steps = np.array([1, 49, 48, 47, -1, -49, -48, -47], np.int16)
    start, chain = int(mask.ravel().argmax()), np.zeros(400, np.uint8)
    length = run(mask.ravel(), 48, start, steps, chain, 400)
    return chain, word(length)


def play_corners(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture = lcg.bytes(36).reshape(6, 6).repeat(4, 0).repeat(4, 1).ravel()
    places = [(0, 3), (1, 3), (2, 2), (3, 1), (3, 0), (3, -1), (2, -2), (1, -3)]
    ring = np.array([y * 24 + x for y, x in places] + [-y * 24 - x for y, x in places], np.int16)
    out = np.zeros(576, np.uint8)
    found = run(picture, ring, out, 24, 24, 20)
    return out, word(found)


def play_peaks(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    found = np.zeros(100, np.int16)
    count = run(lcg.scaled(40 * 30, 100, kind="u2"), 40, 30, 60, found, 50)
    return found, word(count)


CASES = (
    Case(prewitt_edges, 2301, play_prewitt, exported=True),
    Case(strengthen_edges, 2302, play_strengthen, exported=True),
    Case(follow_outline, 2303, play_outline, exported=True),
    Case(ring_corners, 2304, play_corners, exported=True),
    Case(vote_peaks, 2305, play_peaks, exported=True),
)
