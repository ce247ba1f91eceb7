"""Sorting by exchanges, and a fill with two stacks: bubble sort, comb sort, coordinates."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8


@kernel
def bubble_sort(a: i16[:], n: i32) -> i32:
    passes = 0
    swapped = 1
    while swapped != 0:
        swapped = 0
        for i in range(1, n):
            if a[i - 1] > a[i]:
                t = a[i]
                a[i] = a[i - 1]
                a[i - 1] = t
                swapped = 1
        passes += 1
        n -= 1
    return passes


@kernel
def comb_sort(a: i32[:], n: i32) -> None:
    gap = n
    swapped = 1
    while gap > 1 or swapped != 0:
        gap = (gap * 79) >> 7
        if gap < 1:
            gap = 1
        swapped = 0
        for i in range(n - gap):
            x = a[i]
            y = a[i + gap]
            if x > y:
                a[i] = y
                a[i + gap] = x
                swapped = 1


@kernel
def fill_xy(
    image: u8[:], w: i32, h: i32, x0: i32, y0: i32, xs: u8[:], ys: u8[:], dx: i16[:], dy: i16[:]
) -> i32:
    filled = 1
    top = 1
    xs[0] = x0
    ys[0] = y0
    image[y0 * w + x0] = 2
    while top > 0:
        top -= 1
        x = xs[top]
        y = ys[top]
        for k in range(4):
            nx = x + dx[k]
            ny = y + dy[k]
            if nx < 0 or ny < 0 or nx >= w or ny >= h:
                continue
            if image[ny * w + nx] == 0:
                image[ny * w + nx] = 2
                xs[top] = nx
                ys[top] = ny
                top += 1
                filled += 1
    return filled


def play_bubble(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = np.array([lcg.u16() - 32768 for _ in range(80)], np.int16)
    passes = run(a, 80)
    return a, word(passes)


def play_comb(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = np.array([lcg.u16() - 32768 for _ in range(150)], np.int32)
    run(a, 150)
    return (a,)


def play_fill(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image = np.array([lcg.u8() < 70 for _ in range(32 * 24)], np.uint8)
    xs, ys = np.zeros(32 * 24, np.uint8), np.zeros(32 * 24, np.uint8)
    dx, dy = np.array([1, 0, -1, 0], np.int16), np.array([0, 1, 0, -1], np.int16)
    filled = run(image, 32, 24, 16, 12, xs, ys, dx, dy)
    return image, word(filled)


CASES = (
    Case(bubble_sort, 1301, play_bubble),
    Case(comb_sort, 1302, play_comb),
    Case(fill_xy, 1312, play_fill),
)
