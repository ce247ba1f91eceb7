"""Regions and ways: parts of a graph, a walk along a wall, words in a text."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.grids import walled
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def find_root(parent: u16[:], x: i32) -> i32:
    while parent[x] != x:
        parent[x] = parent[parent[x]]
        x = parent[x]
    return x


@kernel
def union_find(a: u16[:], b: u16[:], n: i32, parent: u16[:], nodes: i32) -> i32:
    parts = nodes
    for i in range(nodes):
        parent[i] = i
    for i in range(n):
        x = find_root(parent, a[i])
        y = find_root(parent, b[i])
        if x < y:
            parent[y] = x
            parts -= 1
        elif y < x:
            parent[x] = y
            parts -= 1
    return parts


@kernel
def maze_walk(wall: u8[:], offset: i16[:], p: i32, goal: i32, limit: i32, visits: u8[:]) -> i32:
    steps = 0
    d = 0
    while p != goal and steps < limit:
        d = (d + 1) & 3
        while wall[p + offset[d]] != 0:
            d = (d - 1) & 3
        p = p + offset[d]
        visits[p] = (visits[p] + 1) & 255
        steps = steps + 1
    return steps


@kernel
def find_words(text: u8[:], n: i32, words: u8[:], count: i32, m: i32, place: i16[:]) -> None:
    for j in range(count):
        found = -1
        for i in range(n - m + 1):
            k = 0
            while k < m and text[i + k] == words[j * m + k]:
                k += 1
            if k == m:
                found = i
                break
        place[j] = found


def play_union(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    parent = np.zeros(300, np.uint16)
    parts = run(lcg.scaled(250, 300, kind="u2"), lcg.scaled(250, 300, kind="u2"), 250, parent, 300)
    return parent, word(parts)


def play_maze(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    wall, visits = walled(lcg, 30, 20, 150), np.zeros(600, np.uint8)
    wall[31:33] = 0
    steps = run(wall, np.array([1, 30, -1, -30], np.int16), 31, 568, 1000, visits)
    return visits, word(steps)


def play_words(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    place = np.zeros(12, np.int16)
    run(lcg.scaled(160, 3, 97, "u1"), 160, lcg.scaled(48, 3, 97, "u1"), 12, 4, place)
    return (place,)


CASES = (
    Case(union_find, 1136, play_union),
    Case(maze_walk, 1138, play_maze),
    Case(find_words, 1148, play_words),
)
