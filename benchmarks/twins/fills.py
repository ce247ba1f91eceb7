"""Fills with a stack, and parts of a graph by their size."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8


@kernel
def fill_stack(image: u8[:], w: i32, h: i32, start: i32, colour: i32, stack: i32[:]) -> i32:
    old = image[start]
    count = 0
    top = 1
    stack[0] = start
    while top > 0:
        top -= 1
        p = stack[top]
        if image[p] != old:
            continue
        image[p] = colour
        count += 1
        x = p & (w - 1)
        if x > 0:
            stack[top] = p - 1
            top += 1
        if x < w - 1:
            stack[top] = p + 1
            top += 1
        if p >= w:
            stack[top] = p - w
            top += 1
        if p < w * (h - 1):
            stack[top] = p + w
            top += 1
    return count


@kernel
def span_fill(image: u8[:], w: i32, h: i32, x: i32, y: i32, stack: i16[:]) -> i32:
    sp = 2
    deepest = 2
    stack[0] = x
    stack[1] = y
    while sp > 0:
        sp -= 2
        x = stack[sp]
        y = stack[sp + 1]
        row = y * w
        while x > 0 and image[row + x - 1] == 0:
            x -= 1
        above = 0
        below = 0
        while x < w and image[row + x] == 0:
            image[row + x] = 2
            if y > 0:
                if image[row - w + x] != 0:
                    above = 0
                elif above == 0:
                    stack[sp] = x
                    stack[sp + 1] = y - 1
                    sp += 2
                    above = 1
            if y < h - 1:
                if image[row + w + x] != 0:
                    below = 0
                elif below == 0:
                    stack[sp] = x
                    stack[sp + 1] = y + 1
                    sp += 2
                    below = 1
            x += 1
        if sp > deepest:
            deepest = sp
    return deepest


@kernel
def paint_runs(image: u8[:], w: i32, h: i32, ends: i16[:]) -> i32:
    painted = 0
    for y in range(1, h):
        row = y * w
        x = 0
        n = 0
        while x < w:
            start = x
            while x < w and image[row + x] == 0:
                x += 1
            touched = 0
            for i in range(start, x):
                if image[row - w + i] == 2:
                    touched = 1
            if touched != 0:
                for i in range(start, x):
                    image[row + i] = 2
                ends[n] = x
                n += 1
                painted += x - start
            x += 1
    return painted


@kernel
def left_edges(
    image: u8[:], w: i32, px: u8[:], py: u8[:], n: i32, level: i32, left: u8[:], width: u8[:]
) -> None:
    for i in range(n):
        row = py[i] * w
        a = px[i]
        b = a
        while a > 0 and image[row + a - 1] < level:
            a -= 1
        while b < w - 1 and image[row + b + 1] < level:
            b += 1
        left[i] = a
        width[i] = b - a + 1


@kernel
def union_by_size(a: u8[:], b: u8[:], n: i32, parent: i32[:], size: i32[:], nodes: i32) -> i32:
    largest = 1
    for i in range(nodes):
        parent[i] = i
        size[i] = 1
    for i in range(n):
        x = a[i]
        while parent[x] != x:
            x = parent[x]
        y = b[i]
        while parent[y] != y:
            y = parent[y]
        if x == y:
            continue
        if size[x] < size[y]:
            t = x
            x = y
            y = t
        parent[y] = x
        size[x] += size[y]
        if size[x] > largest:
            largest = size[x]
    return largest


def play_fill(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image = np.array([lcg.u8() < 64 for _ in range(32 * 32)], np.uint8)
    image[16 * 32 + 16] = 0
    count = run(image, 32, 32, 16 * 32 + 16, 7, np.zeros(4 * 32 * 32, np.int32))
    return image, word(count)


def play_span(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image = np.array([lcg.u8() < 60 for _ in range(40 * 30)], np.uint8)
    image[15 * 40 + 20] = 0
    deepest = run(image, 40, 30, 20, 15, np.zeros(1000, np.int16))
    return image, word(deepest)


def play_runs(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image = np.array([lcg.u8() < 80 for _ in range(48 * 24)], np.uint8)
    image[:48] = 2
    painted = run(image, 48, 24, np.zeros(48, np.int16))
    return image, word(painted)


def play_edges(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image, px, py = lcg.bytes(64 * 16), lcg.scaled(100, 64, kind="u1"), lcg.scaled(100, 16, kind="u1")
    left, width = np.zeros(100, np.uint8), np.zeros(100, np.uint8)
    run(image, 64, px, py, 100, 220, left, width)
    return left, width


def play_union(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a, b = lcg.bytes(200), lcg.bytes(200)
    parent, size = np.zeros(256, np.int32), np.zeros(256, np.int32)
    largest = run(a, b, 200, parent, size, 256)
    return parent, word(largest)


CASES = (
    Case(fill_stack, 1206, play_fill),
    Case(span_fill, 1226, play_span),
    Case(paint_runs, 1244, play_runs),
    Case(left_edges, 1247, play_edges),
    Case(union_by_size, 1209, play_union),
)
