"""Loops up to a bound and with it, with another end; and what only the first iteration does without."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def longest_match(buf: u8[:], start: i32, end: i32, most: i32, length: u16[:]) -> i32:
    """How far back the longest match is, the nearest one of several."""
    best = 0
    at = -1
    pos = end - 1
    while pos >= start:
        if buf[pos + best] == buf[end + best] and buf[pos] == buf[end]:
            n = 1
            while n < most:
                if buf[pos + n] != buf[end + n]:
                    break
                n += 1
            if n > best:
                best = n
                at = pos
                if n == most:
                    break
        pos -= 1
    if best > 2:
        length[0] = best
        return end - at
    return -1


@kernel
def next_on_path(px: i16[:], py: i16[:], x: i32, y: i32, look: i32, nearest: i32) -> i32:
    """The first point of a path that is `look` away, behind the nearest one of the next twenty."""
    best = nearest
    best_d = 0x7FFFFFFF
    i = nearest
    while i < len(px) and i < nearest + 20:
        dx = px[i] - x
        dy = py[i] - y
        d = dx * dx + dy * dy
        if d < best_d:
            best_d = d
            best = i
        i += 1
    while best < len(px) - 1:
        dx = px[best] - x
        dy = py[best] - y
        if dx * dx + dy * dy >= look * look:
            break
        best += 1
    return best


@kernel
def rises(row: u8[:], n: i32) -> i32:
    """How many elements begin a run, and how many of them are larger than the one before."""
    begun = 0
    larger = 0
    for i in range(n):
        if i == 0 or row[i] != row[i - 1]:
            begun += 1
    for i in range(n):
        if i > 0 and row[i] > row[i - 1]:
            larger += 1
    return (begun << 16) | larger


def play_match(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    buf, left = (97 + (lcg.bytes(400) & 3)).astype(np.uint8), []
    for end in (150, 200, 260, 333):
        length = np.zeros(1, np.uint16)
        left += [word(run(buf, end - 128, end, 16, length)), length]
    return tuple(left)


def play_path(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    px, py = (np.cumsum(lcg.scaled(80, 40, offset)).astype(np.int16) for offset in (0, -20))
    return tuple(word(run(px, py, int(px[k]) + 10, int(py[k]) - 15, 100, k)) for k in (0, 10, 25, 50, 70))


def play_row(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    return (word(run(lcg.bytes(200) >> 5, 200)),)


CASES = (
    Case(longest_match, 2611, play_match, exported=True),
    Case(next_on_path, 2612, play_path, exported=True),
    Case(rises, 2613, play_row, exported=True),
)
