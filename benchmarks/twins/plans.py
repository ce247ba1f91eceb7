"""Planning on a table: an area, a disc, intervals that meet, shortest ways."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def outline_area(xs: i16[:], ys: i16[:], n: i32) -> i32:
    twice = 0
    for i in range(n):
        following = i + 1
        if following == n:
            following = 0
        twice += xs[i] * ys[following] - xs[following] * ys[i]
    return abs(twice) >> 1


@kernel
def draw_disc(out: u8[:], w: i32, h: i32, cx: i32, cy: i32, radius: i32) -> i32:
    inside = 0
    limit = radius * radius
    for y in range(h):
        dy = y - cy
        for x in range(w):
            dx = x - cx
            if dx * dx + dy * dy <= limit:
                out[y * w + x] = 255
                inside += 1
            else:
                out[y * w + x] = 0
    return inside


@kernel
def merge_intervals(starts: i16[:], ends: i16[:], n: i32) -> i32:
    for i in range(1, n):
        start = starts[i]
        end = ends[i]
        j = i - 1
        while j >= 0 and starts[j] > start:
            starts[j + 1] = starts[j]
            ends[j + 1] = ends[j]
            j -= 1
        starts[j + 1] = start
        ends[j + 1] = end
    kept = 0
    for i in range(1, n):
        if starts[i] <= ends[kept]:
            ends[kept] = max(ends[kept], ends[i])
        else:
            kept += 1
            starts[kept] = starts[i]
            ends[kept] = ends[i]
    return kept + 1


@kernel
def shortest_ways(costs: u8[:], n: i32, start: i32, distances: u16[:], done: u8[:]) -> i32:
    for i in range(n):
        distances[i] = 65535
        done[i] = 0
    distances[start] = 0
    settled = 0
    while settled < n:
        nearest = -1
        least = 65535
        for i in range(n):
            if done[i] == 0 and distances[i] < least:
                least = distances[i]
                nearest = i
        if nearest < 0:
            break
        done[nearest] = 1
        settled += 1
        for i in range(n):
            cost = costs[nearest * n + i]
            if cost != 0 and least + cost < distances[i]:
                distances[i] = least + cost
    return settled


def play_area(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    return (word(run(lcg.scaled(200, 600, -300), lcg.scaled(200, 600, -300), 200)),)


def play_disc(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(32 * 24, np.uint8)
    inside = run(out, 32, 24, 10 + lcg.below(12), 8 + lcg.below(8), 9)
    return out, word(inside)


def play_intervals(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    starts = lcg.scaled(50, 1000, 0)
    ends = starts + lcg.scaled(50, 30, 1)
    kept = run(starts, ends, 50)
    return starts, ends, word(kept)


def play_ways(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    n = 20
    costs = np.array([lcg.below(90) * (lcg.below(3) == 0) for _ in range(n * n)], np.uint8)
    distances, done = np.zeros(n, np.uint16), np.zeros(n, np.uint8)
    settled = run(costs, n, 3, distances, done)
    return distances, done, word(settled)


CASES = (
    Case(outline_area, 2741, play_area, exported=True),
    Case(draw_disc, 2742, play_disc, exported=True),
    Case(merge_intervals, 2743, play_intervals, exported=True),
    Case(shortest_ways, 2744, play_ways, exported=True),
)
