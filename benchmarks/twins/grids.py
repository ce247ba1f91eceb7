"""Stacks, queues and runs: flood fill, breadth-first search, run-length encoding."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def flood_fill(image: u8[:], w: i32, start: i32, colour: i32, stack: u16[:]) -> i32:
    old = image[start]
    count = 0
    sp = 1
    stack[0] = start
    image[start] = colour
    while sp > 0:
        sp -= 1
        p = stack[sp]
        count += 1
        if image[p - 1] == old:
            image[p - 1] = colour
            stack[sp] = p - 1
            sp += 1
        if image[p + 1] == old:
            image[p + 1] = colour
            stack[sp] = p + 1
            sp += 1
        if image[p - w] == old:
            image[p - w] = colour
            stack[sp] = p - w
            sp += 1
        if image[p + w] == old:
            image[p + w] = colour
            stack[sp] = p + w
            sp += 1
    return count


@kernel
def rle_encode(src: u8[:], n: i32, out: u8[:]) -> i32:
    i = 0
    k = 0
    while i < n:
        v = src[i]
        run = 1
        while i + run < n and run < 255 and src[i + run] == v:
            run += 1
        out[k] = run
        out[k + 1] = v
        k += 2
        i += run
    return k


@kernel
def grid_bfs(wall: u8[:], cells: i32, start: i32, offset: i16[:], dist: i16[:], queue: u16[:]) -> i32:
    for i in range(cells):
        dist[i] = -1
    head = 0
    tail = 1
    queue[0] = start
    dist[start] = 0
    while head < tail:
        p = queue[head]
        after = dist[p] + 1
        head = head + 1
        for d in range(4):
            q = p + offset[d]
            if wall[q] != 0 or dist[q] >= 0:
                continue
            dist[q] = after
            queue[tail] = q
            tail = tail + 1
    return tail


def walled(lcg: Lcg, w: int, h: int, above: int) -> Array:
    """Draw a grid with walls where the byte is above a limit, and on the border."""
    grid = (lcg.bytes(w * h) > above).astype(np.uint8).reshape(h, w)
    grid[0] = grid[-1] = 1
    grid[:, 0] = grid[:, -1] = 1
    return grid.ravel()


def play_flood(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image = walled(lcg, 48, 32, 180)
    image[776] = 0
    count = run(image, 48, 776, 2, np.zeros(48 * 32, np.uint16))
    return image, word(count)


def play_rle(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    src, out = np.zeros(1500, np.uint8), np.zeros(3000, np.uint8)
    v = 0
    for i in range(1500):
        v = lcg.u8() >> 6 if lcg.u8() < 40 else v
        src[i] = v
    size = run(src, 1500, out)
    return out[:size], word(size)


def play_bfs(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    wall = walled(lcg, 40, 30, 190)
    wall[41] = 0
    dist = np.zeros(1200, np.int16)
    visited = run(wall, 1200, 41, np.array([1, 40, -1, -40], np.int16), dist, np.zeros(1200, np.uint16))
    return dist, word(visited)


CASES = (
    Case(flood_fill, 1135, play_flood),
    Case(rle_encode, 1137, play_rle),
    Case(grid_bfs, 1139, play_bfs),
)
